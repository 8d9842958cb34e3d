// The JSON of a touch session.
#pragma once

#include "apps/cli/results.hpp"
#include "apps/cli/touch_report.hpp"

namespace palpate {

Json toJson(const TouchReport& report);

void listTouchResults(std::vector<ResultFacts>& all);

}  // namespace palpate
