// Vector types of the whole program: GLM's, under short names. Single precision is what the GPU sees; double precision
// is for file coordinates, analytic truth and the reference implementations.
#pragma once

#include <cmath>
#include <glm/ext/quaternion_double.hpp>
#include <glm/ext/quaternion_geometric.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "shaders/shared/frame.h"

namespace palpate {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Mat4 = glm::mat4;
using DVec2 = glm::dvec2;
using DVec3 = glm::dvec3;
using DVec4 = glm::dvec4;
using DQuat = glm::dquat;  // w, x, y, z
using IVec3 = glm::ivec3;
using UVec2 = glm::uvec2;
using UVec3 = glm::uvec3;

template <class V>
bool isFinite(const V& v) {
  for (int k = 0; k < V::length(); ++k)
    if (!std::isfinite(v[k])) return false;
  return true;
}

/// Angle between two vectors, degrees; accurate for small angles too.
inline double angleBetween_deg(const DVec3& a, const DVec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * (180.0 / 3.14159265358979323846);
}

/// Two unit vectors that complete the unit vector `n` to a right-handed frame (Duff et al. 2017).
struct Frame3 {
  DVec3 u, v, n;
};
inline Frame3 frameAround(const DVec3& n) {
  Frame3 frame{.u = {}, .v = {}, .n = n};
  shared::frameAround(n, frame.u, frame.v);
  return frame;
}

}  // namespace palpate
