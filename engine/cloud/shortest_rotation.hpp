#pragma once

#include "engine/core/vec.hpp"

namespace palpate {

/// The shortest rotation from one unit vector to another; about any perpendicular axis if they are opposite.
inline DQuat shortestRotation(const DVec3& from, const DVec3& to) {
  const double cosine = glm::dot(from, to);
  if (cosine > -1 + 1e-12) return glm::normalize(DQuat(1 + cosine, glm::cross(from, to)));
  return DQuat(0, frameAround(from).u);
}

}  // namespace palpate
