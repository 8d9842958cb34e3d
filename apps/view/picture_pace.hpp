// Frame times, and how long the window may wait for events before it looks for changes again.
#pragma once

#include <cstdint>
#include <deque>

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
  /// How long to wait for events before the next frame. `lives`: something may move without an event.
  double wait_s(bool lives) const;

  std::uint64_t count() const { return count_; }  ///< number of shown frames so far
  double fps() const { return fps_; }             ///< smoothed
  double last_ms() const { return times_ms_.empty() ? 0 : double{times_ms_.back()}; }
  const std::deque<float>& times_ms() const { return times_ms_; }

 private:
  std::deque<float> times_ms_;  // the last ones, for the curve
  std::uint64_t count_ = 0;
  double fps_ = 0;
  Stopwatch sinceBegin_, active_;
  bool shown_ = true;
};

}  // namespace palpate
