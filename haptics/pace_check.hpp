// What a machine can keep to, before anything is touched.
#pragma once

#include "haptics/scheduling_statistics.hpp"
#include "haptics/tick_histogram.hpp"

namespace palpate {

struct PaceCheck {
  std::uint64_t ticks = 0;   ///< that came
  std::uint64_t missed = 0;  ///< that did not, since the one before came late by a whole period
  TickHistogram late_us;     ///< by how much each came late
  SchedulingStatistics scheduling;
  bool realtimePriority = false;
};

/// The servo loop's waiting alone, on the calling thread and with the priority that it may have: each tick comes, and
/// nothing is done. What is missed here no work makes up for. Throws UsageError
/// as plannedTicks() does.
PaceCheck checkPace(double rate_Hz, double duration_s);

}  // namespace palpate
