// Intersections of rays with a shape: ground truth for pictures.
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

/// A surface for rays. Valid while the shape or mesh that it was made from lives; safe from any thread.
struct TracedSurface {
  DVec3 center{0};
  double size = 0;  ///< side of a cube around the centre that holds all of it, model units
  std::function<SurfacePoint(const DVec3&)> closest;
};
TracedSurface traced(const AnalyticShape& shape);
/// `bounds`: of the mesh or a scan of it, model units.
TracedSurface traced(const TriangleMesh& mesh, const Bounds& bounds);

/// The first intersection of a ray from outside with the surface, by sphere tracing (Hart 1996): no step exceeds the
/// distance to the closest point. Accurate to a millionth of the surface's size; rays that graze it by less may hit or
/// miss.
std::optional<RayHit> castRay(const TracedSurface& surface, const Ray& ray);

}  // namespace palpate
