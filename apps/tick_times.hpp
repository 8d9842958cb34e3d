// How the servo thread kept its time, in words and as JSON.
#pragma once

#include <string>

#include "apps/context.hpp"
#include "haptics/thread_toll.hpp"
#include "haptics/tick_histogram.hpp"

namespace palpate {

/// One line of quantiles.
std::string inWords(const TickHistogram& times);
/// Of the bins that hold something: where each begins, and how many ticks it holds.
Json toJson(const TickHistogram& times);

std::string inWords(const ThreadToll& toll);
Json toJson(const ThreadToll& toll);

}  // namespace palpate
