#pragma once

#include <optional>
#include <vector>

#include "engine/core/touch_backend.hpp"

namespace palpate {

/// What a session has come to so far.
struct TouchStatistics {
  TouchShortfalls shortfalls;
  std::vector<double> editTimes_us;  ///< TouchBackend::editTimes_us
  /// For each of these edits what it took then to find where points should come and go with the next one; 0 where the
  /// edit's time includes it.
  std::vector<double> requestTimes_us;
  std::optional<double> firstEditTime_s;  ///< TouchBackend::firstEditTime_s
};

}  // namespace palpate
