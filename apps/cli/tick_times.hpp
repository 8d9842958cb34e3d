// Timing of the servo thread in words and as JSON.
#pragma once

#include <string>

#include "apps/cli/context.hpp"
#include "haptics/scheduling_statistics.hpp"
#include "haptics/tick_histogram.hpp"

namespace palpate {

/// One line of quantiles.
std::string inWords(const TickHistogram& times);
/// The lower limits and the tick counts of the non-empty bins.
Json toJson(const TickHistogram& times);

std::string inWords(const SchedulingStatistics& scheduling);
Json toJson(const SchedulingStatistics& scheduling);

}  // namespace palpate
