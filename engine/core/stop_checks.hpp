// For loops, and comparisons of a sort, that are short each.
#pragma once

#include <cstdint>

#include "engine/core/job_stop.hpp"

namespace palpate {

/// Asks JobStop once in some thousand calls. One thread uses it.
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
