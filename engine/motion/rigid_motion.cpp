#include "engine/motion/rigid_motion.hpp"

#include <cmath>
#include <numbers>

namespace palpate {

RigidPose RigidMotion::poseAt(double time_s) const {
  const double rate = 2 * std::numbers::pi * frequency_Hz, phase = rate * time_s;
  switch (kind) {
    case MotionKind::oscillate:
      return {.centre = centre,
              .offset = amplitude * std::sin(phase) * axis,
              .velocity = amplitude * rate * std::cos(phase) * axis};
    case MotionKind::drift:
      return {.centre = centre, .offset = speed * time_s * axis, .velocity = speed * axis};
    case MotionKind::turn:
      return {
          .centre = centre, .turn = DQuat(std::cos(0.5 * phase), std::sin(0.5 * phase) * axis), .spin = rate * axis};
  }
  return {};
}

}  // namespace palpate
