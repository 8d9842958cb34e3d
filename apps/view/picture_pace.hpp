// Frame times.
#pragma once

#include <cstdint>
#include <deque>

namespace palpate {

class PicturePace {
 public:
  void add(double time_ms);
  std::uint64_t count() const { return count_; }  ///< number of frames so far
  double fps() const { return fps_; }             ///< smoothed
  double last_ms() const { return times_ms_.empty() ? 0 : double{times_ms_.back()}; }
  const std::deque<float>& times_ms() const { return times_ms_; }

 private:
  std::deque<float> times_ms_;  // the last ones, for the curve
  std::uint64_t count_ = 0;
  double fps_ = 0;
};

}  // namespace palpate
