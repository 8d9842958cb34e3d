#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "engine/motion/depth_read_ahead.hpp"
#include "engine/motion/play_counts.hpp"
#include "engine/motion/playback_time.hpp"

namespace palpate {

struct PlayOptions {
  double speed = 1;   ///< of a recorded stream: its seconds in one of the session's; above 0
  bool loop = false;  ///< of a recorded stream: after the last frame the first one follows
  /// Of a recorded stream: the frame that is due is waited for, so that the same time has the same frame. Otherwise it
  /// is played against the clock: what comes too late is dropped.
  bool exact = true;
};

/// Plays a depth stream in the time of a session. Calls are for one thread at a time, but for counts().
class DepthPlayer {
 public:
  /// `first`: a frame of a live stream that was taken from it before; it is the present one, and what nextDue() hands
  /// out comes behind it.
  explicit DepthPlayer(std::shared_ptr<DepthStream> stream, const PlayOptions& options = {},
                       std::optional<DepthFrame> first = {});

  const DepthCamera& camera() const { return ahead_.stream().camera(); }

  struct Played {
    const DepthFrame& frame;   ///< valid until the next call
    double time_s = 0;         ///< of the session, from which on it was the newest one
    std::uint64_t serial = 0;  ///< another one for another frame; of a recorded stream the same for the same frame
    /// Of frameAt(): the one that was played before it, in the same pass of a recording; null where there is none. In
    /// exact play always the one that comes before it in the recording.
    const DepthFrame* before = nullptr;
    /// Until the next one is due, as far as that is known: otherwise as long as since the one before.
    double lasts_s = 0;
  };
  /// The newest frame that is due at a time of the session. Recorded: the last of those up to its place in the
  /// recording, or the first one that could be read where none was. Live: the last that has come. Waits for the first
  /// one. Throws Error where there is none and none will come.
  Played frameAt(double time_s);
  /// The same frames one after another, for a map that each of them goes into: the next one that is due at a time of
  /// the session and was not handed out before. Recorded and exact: every one, in order and without a gap, of all
  /// passes. Otherwise the newest alone, and what it overtakes is dropped. Nothing where all have been; waits for the
  /// first one, and where it plays exactly for the next. A time that has gone back begins anew, as rewindFor() says.
  std::optional<Played> nextDue(double time_s);
  /// Recorded: where a frame that nextDue() has handed out is not due yet at that time, it begins anew, from the first
  /// frame on or behind the one that beginBehind() or beginHere() has named. Whether it did: then a map begins anew.
  bool rewindFor(double time_s);

  using Place = DepthReadAhead::Place;
  /// Recorded: goes to a frame, as if all up to it had been handed out: nextDue() begins behind it. Waits for it.
  void beginBehind(const Place& place);
  /// Likewise, behind the present frame.
  void beginHere() { begin_ = current_; }
  /// Live: whether none has come for so long that the last one says nothing any more (DepthStream::staysTrue_s()).
  bool isOutdated(double time_s) const;

  /// The last frame that was handed out did not go into the map: it counts as lost, for that reason.
  void leaveOut(const std::string& why);
  /// Frames that could not be read since the last call, and why the last one of them.
  struct Losses {
    std::uint64_t frames = 0;
    std::string why;
  };
  Losses takeLosses();

  /// Recorded, from that time of the session on. What is live holds its frame while it is paused.
  void pause(double time_s) { time_.pause(time_s); }
  void play(double time_s);
  void setSpeed(double speed, double time_s) { time_.setSpeed(speed, time_s); }
  /// Pauses at the present frame: one that is due by now and was not asked for comes only once it goes on.
  void hold(double time_s);
  bool isPaused() const { return time_.isPaused(); }
  /// PlayOptions::exact, of a recorded stream.
  bool isExact() const { return options_.exact && ahead_.stream().isRecorded(); }
  /// Recorded, while it is paused: goes to the next frame; stays where there is none.
  void step();

  /// From any thread.
  PlayCounts counts() const;
  /// From where the newest frame that was handed out was seen; nothing where it does not say. From any thread.
  std::optional<PlayedView> view() const;

 private:
  Place placeAt(double time_s) const;
  void takeNext(const Place& place);
  void keepBefore();
  double lasts_s();
  bool isBackAt(const Place& due) const;
  bool isDueAt(const Place& due, const Place& next) const;
  // How many frames they took: recorded and exact the next one that is due, otherwise all of them.
  std::uint64_t takeDue(const Place& due);
  std::uint64_t takeLive(double time_s);
  void playRecorded(double time_s);
  void playLive(double time_s);
  void restart(std::uint64_t pass);
  void goBehind(const Place& place);
  void requireFrame() const;
  void count(double time_s, std::uint64_t taken);
  Played present() const;
  // Of frame_; while mutex_ is held.
  void noteView();

  const PlayOptions options_;
  DepthReadAhead ahead_;
  const double period_s_;  // of a loop
  PlaybackTime time_;
  DepthFrame frame_, before_;
  std::optional<Place> current_;  // that of frame_; none: there is none yet
  std::optional<Place> begin_;    // what nextDue() hands out comes behind it
  double currentSince_s_ = 0;
  std::optional<double> beforeSince_s_;  // that before_ was due; none: it is of another pass, or there is none
  std::uint64_t lossesTaken_ = 0;
  std::optional<double> liveOffset_s_;  // from the time of a live stream to the session's

  mutable std::mutex mutex_;  // of what follows
  std::uint64_t played_ = 0, dropped_ = 0, leftOut_ = 0;
  std::string lastLeftOut_;  // why
  double asked_s_ = 0, lastCame_s_ = 0;
  std::optional<PlayedView> view_;
};

}  // namespace palpate
