#pragma once

#include <chrono>

namespace palpate {

/// Monotonic time for measurements and pacing.
class Stopwatch {
 public:
  using Clock = std::chrono::steady_clock;
  double elapsed_us() const { return std::chrono::duration<double, std::micro>(Clock::now() - start_).count(); }
  double elapsed_s() const { return elapsed_us() * 1e-6; }

 private:
  Clock::time_point start_ = Clock::now();
};

}  // namespace palpate
