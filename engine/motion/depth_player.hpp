#pragma once

#include <memory>
#include <mutex>
#include <optional>

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
  /// `first`: a frame of a live stream that was taken from it before.
  explicit DepthPlayer(std::shared_ptr<DepthStream> stream, const PlayOptions& options = {},
                       std::optional<DepthFrame> first = {});

  const DepthCamera& camera() const { return ahead_.stream().camera(); }

  struct Played {
    const DepthFrame& frame;   ///< valid until the next call
    double time_s = 0;         ///< of the session, from which on it was the newest one
    std::uint64_t serial = 0;  ///< another one for another frame; of a recorded stream the same for the same frame
  };
  /// The newest frame that is due at a time of the session. Recorded: the last of those up to its place in the
  /// recording, or the first one that could be read where none was. Live: the last that has come. Waits for the first
  /// one. Throws Error where there is none and none will come.
  Played frameAt(double time_s);

  /// Recorded, from that time of the session on. What is live holds its frame while it is paused.
  void pause(double time_s) { time_.pause(time_s); }
  void play(double time_s) { time_.play(time_s); }
  void setSpeed(double speed, double time_s) { time_.setSpeed(speed, time_s); }
  bool isPaused() const { return time_.isPaused(); }
  /// Recorded, while it is paused: goes to the next frame; stays where there is none.
  void step();

  /// From any thread.
  PlayCounts counts() const;
  /// CloudSource::playedView(). From any thread.
  std::optional<PlayedView> view() const;

 private:
  using Place = DepthReadAhead::Place;
  Place placeAt(double time_s) const;
  void takeNext(const Place& place);
  void playRecorded(double time_s);
  void playLive(double time_s);
  void requireFrame() const;
  // Of frame_; while mutex_ is held.
  void noteView();

  const PlayOptions options_;
  DepthReadAhead ahead_;
  const double period_s_;  // of a loop
  PlaybackTime time_;
  DepthFrame frame_;
  std::optional<Place> current_;  // that of frame_; none: there is none yet
  double currentSince_s_ = 0;
  std::optional<double> liveOffset_s_;  // from the time of a live stream to the session's

  mutable std::mutex mutex_;  // of what follows
  std::uint64_t played_ = 0, dropped_ = 0;
  double asked_s_ = 0, lastCame_s_ = 0;
  std::optional<PlayedView> view_;
};

}  // namespace palpate
