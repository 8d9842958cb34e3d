#include "haptics/scheduling_statistics.hpp"

namespace palpate {

// Windows counts these for whole processes only.
SchedulingStatistics schedulingOfThisThread() noexcept { return {}; }

}  // namespace palpate
