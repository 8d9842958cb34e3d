// Selections by a volume. Positions are relative to the cloud's origin.
#pragma once

#include <glm/ext/quaternion_common.hpp>
#include <glm/vector_relational.hpp>

#include "engine/select/point_bits.hpp"

namespace palpate {

/// A box along its own axes, a ball, or what is on one side of a plane.
struct Volume {
  enum class Kind : std::uint8_t { box, ball, plane };
  Kind kind = Kind::box;
  DVec3 centre{0};             ///< of a plane: any point of it
  DQuat rotation{1, 0, 0, 0};  ///< unit; from its own axes to the model's
  DVec3 half{1};               ///< half the size of a box along its axes; x: radius of a ball

  DVec3 axis(int k) const {
    DVec3 own(0);
    own[k] = 1;
    return rotation * own;
  }
  /// The border counts. Of a plane: the side to which its z axis points.
  bool contains(const DVec3& position) const {
    const DVec3 arm = position - centre;
    if (kind == Kind::ball) return glm::dot(arm, arm) <= half.x * half.x;
    if (kind == Kind::plane) return glm::dot(arm, axis(2)) >= 0;
    return glm::all(glm::lessThanEqual(glm::abs(glm::conjugate(rotation) * arm), half));
  }
};

/// Those of `among` in the volume.
PointBits pointsIn(std::span<const PointState> points, const PointBits& among, const Volume& volume,
                   unsigned threads = 0);

/// The box of the points along the model's axes; without any, of size 0 at the origin.
Volume boxAround(std::span<const PointState> points, const PointBits& of);

}  // namespace palpate
