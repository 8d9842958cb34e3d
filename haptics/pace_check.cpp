#include "haptics/pace_check.hpp"

#include <algorithm>

#include "haptics/realtime_priority.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate {

PaceCheck checkPace(double rate_Hz, double duration_s) {
  const std::uint64_t planned = plannedTicks(rate_Hz, duration_s);
  const RealtimePriority priority;
  const TickPacer pacer(rate_Hz, priority.granted());
  PaceCheck check{.realtimePriority = priority.granted()};
  const SchedulingStatistics before = schedulingOfThisThread();
  for (std::uint64_t index = 0; index < planned; ++index) {
    const std::uint64_t due = std::min(pacer.waitFor(index), planned);
    check.missed += due - index;
    index = due;
    if (index == planned) break;
    check.late_us.add(-pacer.remaining_us(index));
    ++check.ticks;
  }
  check.scheduling = schedulingOfThisThread() - before;
  return check;
}

}  // namespace palpate
