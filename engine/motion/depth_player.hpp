#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "engine/core/camera_frustum.hpp"
#include "engine/motion/depth_read_ahead.hpp"

namespace palpate {

/// Counts of a depth camera's frames so far.
struct PlayCounts {
  std::uint64_t played = 0;   ///< newest frame at a requested time
  std::uint64_t lost = 0;     ///< could not be read
  std::uint64_t dropped = 0;  ///< not played: a later one was due or already received
  std::string lastLoss;       ///< reason of the last loss; empty: none
  /// Live cameras: session time of the last frame, if that is more than a second ago or no more frames will follow.
  std::optional<double> silentSince_s;
  double staysTrue_s = std::numeric_limits<double>::infinity();  ///< live cameras: DepthStream::staysTrue_s()
};

/// View of the frame that a depth camera plays.
struct PlayedView {
  CameraFrustum frustum;     ///< metres, in the world of the poses
  std::uint64_t number = 0;  ///< frame number (DepthFrame::number)
};

/// Maps session time to the position in a recording, which advances at a speed or is paused. Both in seconds.
class PlaybackTime {
 public:
  explicit PlaybackTime(double speed) : speed_(speed) {}

  double placeAt(double time_s) const { return isPaused_ ? begin_s_ : begin_s_ + speed_ * (time_s - since_s_); }
  /// Session time at which a position is due.
  double timeOf(double place_s) const { return since_s_ + (place_s - begin_s_) / speed_; }

  // Take effect at that session time.
  void pause(double time_s) {
    goTo(placeAt(time_s), time_s);
    isPaused_ = true;
  }
  void play(double time_s) {
    goTo(placeAt(time_s), time_s);
    isPaused_ = false;
  }
  void setSpeed(double speed, double time_s) {
    goTo(placeAt(time_s), time_s);
    speed_ = speed;
  }
  /// Only while paused.
  void stepTo(double place_s) { begin_s_ = place_s; }
  bool isPaused() const { return isPaused_; }
  double speed() const { return speed_; }

 private:
  void goTo(double place_s, double time_s) {
    begin_s_ = place_s;
    since_s_ = time_s;
  }

  double speed_;
  double since_s_ = 0, begin_s_ = 0;  // at session time since_s_ position begin_s_ is due
  bool isPaused_ = false;
};

struct PlayOptions {
  double speed = 1;   ///< recorded streams: recording seconds per session second; above 0
  bool loop = false;  ///< recorded streams: restart after the last frame
  /// Recorded streams: wait for the frame that is due, so that the same time has the same frame. Otherwise the stream
  /// plays in real time: late frames are dropped.
  bool exact = true;
};

/// Plays a depth stream in session time. For one thread at a time, except counts() and view().
class DepthPlayer {
 public:
  /// `first`: a frame already taken from a live stream; it is the current frame, and nextDue() returns later ones.
  explicit DepthPlayer(std::shared_ptr<DepthStream> stream, const PlayOptions& options = {},
                       std::optional<DepthFrame> first = {});

  const DepthCamera& camera() const { return ahead_.stream().camera(); }

  struct Played {
    const DepthFrame& frame;   ///< valid until the next call
    double time_s = 0;         ///< session time at which it became the newest frame
    std::uint64_t serial = 0;  ///< identifies the frame; stable for recorded streams
    /// Set by frameAt(): the frame played before it in the same pass of a recording; null if there is none. In exact
    /// play it is always the preceding frame of the recording.
    const DepthFrame* before = nullptr;
    /// Seconds until the next frame is due; if unknown, the interval since the previous one.
    double lasts_s = 0;
  };
  /// The newest frame due at a session time. Recorded: the last one up to that time of the recording, or the first
  /// readable one. Live: the last one received. Waits for the first frame. Throws Error if there is no frame and none
  /// will follow.
  Played frameAt(double time_s);
  /// For a map, which fuses each frame: the next frame that is due and was not returned before; nothing if all were.
  /// Recorded and exact: every frame of all passes in order; otherwise the newest, and skipped ones count as dropped.
  /// Waits for the first frame, in exact play for the next. A time that went back restarts it, see rewindFor().
  std::optional<Played> nextDue(double time_s);
  /// Recorded: if a frame returned by nextDue() is not yet due at that time, restarts from the first frame, or behind
  /// the one set by beginBehind() or beginHere(). Returns whether it restarted: the map must restart, too.
  bool rewindFor(double time_s);

  using Place = DepthReadAhead::Place;
  /// Recorded: seeks to a frame as if all frames up to it had been returned: nextDue() continues behind it. Waits for
  /// it.
  void beginBehind(const Place& place);
  /// Likewise, behind the current frame.
  void beginHere() { begin_ = current_; }
  /// Live: whether the last frame is no longer valid (DepthStream::staysTrue_s()).
  bool isOutdated(double time_s) const;

  /// The last frame returned was not fused: it counts as lost, with that reason.
  void leaveOut(const std::string& why);
  /// Frames that could not be read since the last call, and the reason for the last one.
  struct Losses {
    std::uint64_t frames = 0;
    std::string why;
  };
  Losses takeLosses();

  /// Recorded streams pause at that session time. Live streams hold their frame while paused.
  void pause(double time_s) { time_.pause(time_s); }
  void play(double time_s);
  void setSpeed(double speed, double time_s) { time_.setSpeed(speed, time_s); }
  /// Pauses at the current frame: a frame that is due but was not requested follows after play().
  void hold(double time_s);
  bool isPaused() const { return time_.isPaused(); }
  /// PlayOptions::exact, of a recorded stream.
  bool isExact() const { return options_.exact && ahead_.stream().isRecorded(); }
  /// Recorded, while paused: advances to the next frame, if there is one.
  void step();

  /// From any thread.
  PlayCounts counts() const;
  /// Camera view of the newest frame returned; nothing if it has no pose. From any thread.
  std::optional<PlayedView> view() const;

 private:
  Place placeAt(double time_s) const;
  void takeNext(const Place& place);
  void keepBefore();
  double lasts_s();
  bool isBackAt(const Place& due) const;
  bool isDueAt(const Place& due, const Place& next) const;
  // Both return the number of frames taken: recorded and exact the next one due, otherwise all of them.
  std::uint64_t takeDue(const Place& due);
  std::uint64_t takeLive(double time_s);
  void playRecorded(double time_s);
  void playLive(double time_s);
  void restart(std::uint64_t pass);
  void goBehind(const Place& place);
  void requireFrame() const;
  void count(double time_s, std::uint64_t taken);
  Played present() const;
  // Requires mutex_.
  void noteView();

  const PlayOptions options_;
  DepthReadAhead ahead_;
  const double period_s_;  // of a loop
  PlaybackTime time_;
  DepthFrame frame_, before_;
  std::optional<Place> current_;  // position of frame_; none: no frame yet
  std::optional<Place> begin_;    // nextDue() returns frames behind it
  double currentSince_s_ = 0;
  std::optional<double> beforeSince_s_;  // when before_ became due; none: no previous frame, or one of another pass
  std::uint64_t lossesTaken_ = 0;
  std::optional<double> liveOffset_s_;  // from the time of a live stream to the session's

  mutable std::mutex mutex_;  // guards the following members
  std::uint64_t played_ = 0, dropped_ = 0, leftOut_ = 0;
  std::string lastLeftOut_;  // reason
  double asked_s_ = 0, lastCame_s_ = 0;
  std::optional<PlayedView> view_;
};

}  // namespace palpate
