// How often the kernel preempted a thread, and how long the thread waited for a core.
#pragma once

#include <cstdint>

namespace palpate {

/// Counted since the thread began. Zero if the kernel does not report it.
struct SchedulingStatistics {
  std::uint64_t preemptions = 0;  ///< times its core was given to another thread
  std::uint64_t pageFaults = 0;
  double waited_us = 0;  ///< in total, ready to run and without a core

  SchedulingStatistics operator-(const SchedulingStatistics& before) const noexcept {
    return {preemptions - before.preemptions, pageFaults - before.pageFaults, waited_us - before.waited_us};
  }
};

/// For the calling thread. Takes some microseconds; does not allocate.
SchedulingStatistics schedulingOfThisThread() noexcept;

}  // namespace palpate
