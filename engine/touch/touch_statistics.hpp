#pragma once

#include <optional>
#include <vector>

#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// Statistics of a session so far.
struct TouchStatistics {
  TouchShortfalls shortfalls;
  std::vector<double> editTimes_us;  ///< BackendReport::editTimes_us
  /// For each of these edits, the time to find where the next edit must add or remove points; 0 if the edit's time
  /// includes it.
  std::vector<double> requestTimes_us;
  std::optional<double> firstEditTime_s;  ///< BackendReport::firstEdit_s
};

}  // namespace palpate
