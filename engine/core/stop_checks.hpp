// Stop checks for short loop bodies and for comparisons of a sort.
#pragma once

#include <cstdint>

#include "engine/core/job_stop.hpp"

namespace palpate {

/// Checks JobStop once in some thousand calls. For one thread.
class StopChecks {
 public:
  /// Throws Stopped.
  void operator()() {
    constexpr std::uint32_t kBetween = 4096;
    if (++count_ % kBetween == 0) throwIfStopWanted();
  }

 private:
  std::uint32_t count_ = 0;
};

}  // namespace palpate
