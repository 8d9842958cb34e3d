#pragma once

#include <algorithm>
#include <cstddef>

#include "engine/core/clock.hpp"

namespace palpate {

/// Divides the budget of a tick on the CPU. It ends in time although the work of its answer is not known before: half
/// of the time left is for the answer, the rest for the patch that bridges it. No limits in virtual time.
class TickLimit {
 public:
  /// A tick begins. `budget_us`: as for ContactQuery::ask().
  void begin(double budget_us) {
    watch_ = {};
    budget_us_ = budget_us;
    isOver_ = false;
  }
  bool isRealtime() const { return budget_us_ > 0; }
  /// How long the tick may wait before it answers; 0: without limit.
  double wait_us() const {
    constexpr double kMargin = 1.5, kWakes_us = 80;  // timers of the system are late by about as much
    return isRealtime() ? budget_us_ - std::min(kMargin * answer_us_ + kWakes_us, 0.5 * budget_us_) : 0;
  }
  void beginAnswer() {
    began_us_ = watch_.elapsed_us();
    limit_us_ = began_us_ + 0.5 * (budget_us_ - began_us_);
    visited_ = next_ = 0;
  }
  /// Whether the answer may visit so many more points or cells. Looks at the clock now and then.
  bool allows(std::size_t more) {
    if (!isRealtime()) return true;
    visited_ += more;
    if (visited_ > next_) {
      constexpr std::size_t kPerLook = 1024;  // some microseconds
      isOver_ = isOver_ || (next_ > 0 && watch_.elapsed_us() > limit_us_);
      next_ = visited_ + kPerLook;
    }
    return !isOver_;
  }
  /// The answer has been abandoned.
  bool isOver() const { return isOver_; }
  /// The tick has been answered, by the patch or not.
  void end() {
    constexpr double kKept = 0.99;  // of the longest one, by tick
    if (isRealtime()) answer_us_ = std::max(kKept * answer_us_, answerTime_us());
  }
  double answerTime_us() const { return watch_.elapsed_us() - began_us_; }

 private:
  Stopwatch watch_;
  double budget_us_ = 0, began_us_ = 0, limit_us_ = 0;
  double answer_us_ = 0;  // of recent ticks, the longest
  std::size_t visited_ = 0, next_ = 0;
  bool isOver_ = false;
};

}  // namespace palpate
