#pragma once

#include "engine/core/vec.hpp"

namespace palpate {

/// Where a hand is.
struct HandPose {
  DVec3 place_m{0};
  DQuat orientation{1, 0, 0, 0};
  double felt = 1;  ///< share of the force that the hand gets, after all limits
};

/// On the way from one to the other, of which `share` has been gone.
HandPose between(const HandPose& from, const HandPose& to, double share);
/// Angular velocity that turns `from` into `to` within `step_s`, rad/s.
DVec3 spinBetween(const DQuat& from, const DQuat& to, double step_s);

}  // namespace palpate
