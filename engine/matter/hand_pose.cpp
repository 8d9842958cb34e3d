#include "engine/matter/hand_pose.hpp"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace palpate {

HandPose between(const HandPose& from, const HandPose& to, double share) {
  return {.place_m = glm::mix(from.place_m, to.place_m, share),
          .orientation = glm::slerp(from.orientation, to.orientation, share)};
}

DVec3 spinBetween(const DQuat& from, const DQuat& to, double step_s) {
  DQuat turn = to * glm::conjugate(from);
  if (turn.w < 0) turn = -turn;
  const DVec3 axis(turn.x, turn.y, turn.z);
  const double sine = glm::length(axis);
  return sine > 0 ? axis / sine * (2 * std::atan2(sine, turn.w) / step_s) : DVec3(0);
}

}  // namespace palpate
