// Where rays meet a shape: the truth of a picture.
#pragma once

#include <functional>
#include <optional>

#include "engine/cloud/triangle_mesh.hpp"

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

/// What rays may meet. Valid as long as the shape or the mesh that it was made from; safe from any thread.
struct TracedSurface {
  DVec3 center{0};
  double size = 0;  ///< side of a cube around the centre that holds all of it, model units
  std::function<SurfacePoint(const DVec3&)> closest;
};
TracedSurface traced(const AnalyticShape& shape);
/// `bounds`: of the mesh or a scan of it, model units.
TracedSurface traced(const TriangleMesh& mesh, const Bounds& bounds);

/// The first point of the surface that a ray from outside meets, by sphere tracing (Hart 1996): no step is longer than
/// the way to the closest point. Within a millionth of the surface's size; rays that graze it by less may hit or miss.
std::optional<RayHit> castRay(const TracedSurface& surface, const Ray& ray);

}  // namespace palpate
