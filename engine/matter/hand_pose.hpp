#pragma once

#include "engine/core/vec.hpp"

namespace palpate {

/// Pose of a hand.
struct HandPose {
  DVec3 place_m{0};
  DQuat orientation{1, 0, 0, 0};
  double felt = 1;  ///< share of the force that the hand receives, after all limits
};

/// Interpolated pose; `share`: 0 is `from`, 1 is `to`.
HandPose between(const HandPose& from, const HandPose& to, double share);
/// Angular velocity that rotates `from` into `to` within `step_s`, rad/s.
DVec3 spinBetween(const DQuat& from, const DQuat& to, double step_s);

}  // namespace palpate
