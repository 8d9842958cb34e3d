// How the servo thread kept its time, in words and as JSON.
#pragma once

#include <string>

#include "apps/cli/context.hpp"
#include "haptics/scheduling_statistics.hpp"
#include "haptics/tick_histogram.hpp"

namespace palpate {

/// One line of quantiles.
std::string inWords(const TickHistogram& times);
/// Of the bins that hold something: where each begins, and how many ticks it holds.
Json toJson(const TickHistogram& times);

std::string inWords(const SchedulingStatistics& scheduling);
Json toJson(const SchedulingStatistics& scheduling);

}  // namespace palpate
