#pragma once

#include <cstddef>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Tells whether all hands rest away from all surfaces: then no answer is urgent. Allocates nothing after construction.
class RestWatch {
 public:
  /// `radius`: support radius, model units.
  RestWatch(std::size_t hands, double radius) : rests_(kRests * radius), places_(hands) {}

  /// Position of a hand at a time; `isNear`: it has points within reach.
  void note(std::size_t hand, const DVec3& hip, bool isNear, double time_s) {
    if (!isNear && glm::distance(hip, places_[hand]) <= rests_) return;
    places_[hand] = hip;
    stirred_s_ = time_s;
  }
  /// Whether all have rested for a moment.
  bool rests(double time_s) const { return time_s - stirred_s_ >= kAwake_s; }

 private:
  static constexpr double kRests = 0.02;   // of the support radius, within which a hand rests
  static constexpr double kAwake_s = 0.2;  // after its last motion

  double rests_;
  std::vector<DVec3> places_;  // where each hand has last moved to
  double stirred_s_ = 0;
};

}  // namespace palpate
