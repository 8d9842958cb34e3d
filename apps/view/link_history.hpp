// History of the link to the server of a model, for the curves.
#pragma once

#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/shared_follower.hpp"

namespace palpate {

class LinkHistory {
 public:
  static constexpr double kApart_s = 0.1;    ///< interval between two values
  static constexpr std::size_t kKept = 300;  ///< number of values

  /// Called once per frame. Unknown values are stored as 0.
  void add(const SharedCounts& counts);
  void clear();

  const std::vector<float>& roundTrip_ms() const { return roundTrip_ms_; }
  const std::vector<float>& lost_percent() const { return lost_percent_; }
  const std::vector<float>& age_ms() const { return age_ms_; }

 private:
  std::vector<float> roundTrip_ms_, lost_percent_, age_ms_;
  Stopwatch last_;
};

}  // namespace palpate
