#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Tells whether all hands rest away from all surfaces: then no answer is urgent, and few are needed. Allocates nothing
/// after construction.
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
  /// Whether they rest still, and the answer to the question of `asked_s` is new enough to stand for them.
  bool restsOn(std::span<const Pose> poses, double asked_s) const {
    const double time_s = poses.front().time_s;
    if (!rests(time_s) || time_s - asked_s >= kAsks_s) return false;
    for (std::size_t i = 0; i < places_.size(); ++i)
      if (!(glm::distance(poses[i].hip, places_[i]) <= rests_)) return false;
    return true;
  }

 private:
  static constexpr double kRests = 0.02;    // of the support radius, within which a hand rests
  static constexpr double kAwake_s = 0.2;   // after its last motion
  static constexpr double kAsks_s = 0.016;  // between questions of hands that rest

  double rests_;
  std::vector<DVec3> places_;  // where each hand has last moved to
  double stirred_s_ = 0;
};

}  // namespace palpate
