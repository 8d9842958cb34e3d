#include "haptics/scheduling_statistics.hpp"

namespace palpate {

// Windows counts such things for whole processes alone.
SchedulingStatistics schedulingOfThisThread() noexcept { return {}; }

}  // namespace palpate
