#pragma once

#include <array>
#include <glm/ext/quaternion_common.hpp>
#include <string_view>
#include <utility>

#include "engine/core/vec.hpp"

namespace palpate {

/// To and fro along an axis; along it at a constant speed; about it.
enum class MotionKind { oscillate, drift, turn };
inline constexpr std::array<std::pair<std::string_view, MotionKind>, 3> kMotionKinds{
    {{"oscillate", MotionKind::oscillate}, {"drift", MotionKind::drift}, {"turn", MotionKind::turn}}};

/// Where a rigid body is at one time, and how it moves then. At rest by default.
struct RigidPose {
  DVec3 centre{0};  ///< at rest; what it turns about
  DQuat turn{1, 0, 0, 0};
  DVec3 offset{0};    ///< of the centre from where it rests
  DVec3 velocity{0};  ///< of the centre, per second
  DVec3 spin{0};      ///< rad/s about the centre

  /// From a place at rest to where it is, and back. A pose at rest gives back the same bits.
  DVec3 moved(const DVec3& rest) const {
    const DVec3 arm = rest - centre;
    return rest + (turn * arm - arm) + offset;
  }
  DVec3 movedBack(const DVec3& place) const { return centre + glm::conjugate(turn) * (place - offset - centre); }
  DVec3 turned(const DVec3& direction) const { return turn * direction; }
  DVec3 turnedBack(const DVec3& direction) const { return glm::conjugate(turn) * direction; }
  /// Of the body at a place where it is now.
  DVec3 velocityAt(const DVec3& place) const { return velocity + glm::cross(spin, place - centre - offset); }
};

/// A rigid body's way as a function of time, in any units of length. At time 0 it is at rest's place.
struct RigidMotion {
  MotionKind kind = MotionKind::oscillate;
  DVec3 axis{0, 0, 1};      ///< unit
  DVec3 centre{0};          ///< of turn
  double amplitude = 0;     ///< of oscillate: half the way from one end to the other
  double frequency_Hz = 0;  ///< of oscillate and turn: times to and fro, or about, in a second
  double speed = 0;         ///< of drift, per second

  RigidPose poseAt(double time_s) const;
};

}  // namespace palpate
