#pragma once

#include <array>
#include <glm/ext/quaternion_common.hpp>
#include <string_view>
#include <utility>

#include "engine/core/vec.hpp"

namespace palpate {

/// Oscillation along an axis; translation along it at constant speed; rotation about it.
enum class MotionKind { oscillate, drift, turn };
inline constexpr std::array<std::pair<std::string_view, MotionKind>, 3> kMotionKinds{
    {{"oscillate", MotionKind::oscillate}, {"drift", MotionKind::drift}, {"turn", MotionKind::turn}}};

/// Pose and velocity of a rigid body at one time. At rest by default.
struct RigidPose {
  DVec3 centre{0};  ///< centre of rotation, at rest
  DQuat turn{1, 0, 0, 0};
  DVec3 offset{0};    ///< displacement of the centre
  DVec3 velocity{0};  ///< of the centre, per second
  DVec3 spin{0};      ///< rad/s about the centre

  /// Maps a position at rest to the current one, and back. The identity pose returns the same bits.
  DVec3 moved(const DVec3& rest) const {
    const DVec3 arm = rest - centre;
    return rest + (turn * arm - arm) + offset;
  }
  DVec3 movedBack(const DVec3& place) const { return centre + glm::conjugate(turn) * (place - offset - centre); }
  DVec3 turned(const DVec3& direction) const { return turn * direction; }
  DVec3 turnedBack(const DVec3& direction) const { return glm::conjugate(turn) * direction; }
  /// Velocity of the body at a current position.
  DVec3 velocityAt(const DVec3& place) const { return velocity + glm::cross(spin, place - centre - offset); }
};

/// Motion of a rigid body as a function of time, in any unit of length. At time 0 it is in its rest position.
struct RigidMotion {
  MotionKind kind = MotionKind::oscillate;
  DVec3 axis{0, 0, 1};      ///< unit
  DVec3 centre{0};          ///< for turn
  double amplitude = 0;     ///< for oscillate: half the distance between the two ends
  double frequency_Hz = 0;  ///< for oscillate and turn: periods per second
  double speed = 0;         ///< for drift, per second

  RigidPose poseAt(double time_s) const;
};

}  // namespace palpate
