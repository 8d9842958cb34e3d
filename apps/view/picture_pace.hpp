// Frame times, and how long the window may wait for events before it looks for changes again.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "engine/core/clock.hpp"

namespace palpate {

class PicturePace {
 public:
  /// A frame begins; returns the time since the one before.
  double begin();
  /// A frame ends. `shown`: otherwise it would not have differed from the one before. Its time counts if the model was
  /// drawn: the curve of these times would change with each frame that shows only the curve.
  void end(bool shown, bool modelDrawn);
  /// Events came: what they change may appear after some frames.
  void wake() { active_ = {}; }
  /// A motion of the mouse is handled in this frame, that long after it happened.
  void noteMouse(double age_s);
  /// The GPU has finished the last frame.
  void finish();
  /// How long to wait for events before the next frame. `lives`: something may move without an event.
  double wait_s(bool lives) const;

  std::uint64_t count() const { return count_; }  ///< number of shown frames so far
  double fps() const { return fps_; }             ///< smoothed
  double last_ms() const { return times_ms_.empty() ? 0 : double{times_ms_.back()}; }
  const std::deque<float>& times_ms() const { return times_ms_; }
  /// From the oldest motion of the mouse that a picture of the model shows first, until it is finished: the last ones.
  const std::deque<float>& mouseToPicture_ms() const { return mouseToPicture_ms_; }

 private:
  std::deque<float> times_ms_, mouseToPicture_ms_;  // the last ones, for the curve and the report
  // Age of the oldest motion that a frame shows, and the time since its age was taken.
  struct Motion {
    double age_s = 0;
    Stopwatch since;
    double now_s() const { return age_s + since.elapsed_s(); }
  };
  std::optional<Motion> mouse_, drawnFor_;  // of this frame, of the model's picture in progress
  std::uint64_t count_ = 0;
  double fps_ = 0;
  Stopwatch sinceBegin_, active_;
  bool shown_ = true;
};

}  // namespace palpate
