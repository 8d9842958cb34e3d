// What the kernel took from a thread that should have run.
#pragma once

#include <cstdint>

namespace palpate {

/// Counted since the thread began. Zero what the kernel does not tell.
struct SchedulingStatistics {
  std::uint64_t preemptions = 0;  ///< times its core was given to another thread
  std::uint64_t pageFaults = 0;
  double waited_us = 0;  ///< in all, ready to run and without a core

  SchedulingStatistics operator-(const SchedulingStatistics& before) const noexcept {
    return {preemptions - before.preemptions, pageFaults - before.pageFaults, waited_us - before.waited_us};
  }
};

/// Of the calling thread. Takes some microseconds; allocates nothing.
SchedulingStatistics schedulingOfThisThread() noexcept;

}  // namespace palpate
