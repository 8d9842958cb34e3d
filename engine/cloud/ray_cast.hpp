// Where rays meet a shape: the truth of a picture.
#pragma once

#include <optional>

#include "engine/cloud/analytic_shape.hpp"

namespace palpate {

struct Ray {
  DVec3 from{0};
  DVec3 along{0, 0, 1};  ///< any length but zero
};

/// A hit lies at from + depth * along.
struct RayHit {
  double depth = 0;
  DVec3 normal{0};  ///< of the surface there, unit
};

/// The first point of the surface that a ray from outside meets, by sphere tracing (Hart 1996): no step is longer than
/// the way to the closest point. Within a millionth of the shape's size; rays that graze it by less may hit or miss.
std::optional<RayHit> castRay(const AnalyticShape& shape, const Ray& ray);

}  // namespace palpate
