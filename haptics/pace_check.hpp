// Measures the pace that a machine can keep, before anything is touched.
#pragma once

#include "haptics/scheduling_statistics.hpp"
#include "haptics/tick_histogram.hpp"

namespace palpate {

struct PaceCheck {
  std::uint64_t ticks = 0;   ///< done
  std::uint64_t missed = 0;  ///< skipped, since the previous one was late by a whole period
  TickHistogram late_us;     ///< lateness of each tick
  SchedulingStatistics scheduling;
  bool realtimePriority = false;
};

/// The waiting of the servo loop alone, on the calling thread with the priority that it is granted: ticks without work.
/// Ticks missed here are missed with any work. Throws UsageError as plannedTicks() does.
PaceCheck checkPace(double rate_Hz, double duration_s);

}  // namespace palpate
