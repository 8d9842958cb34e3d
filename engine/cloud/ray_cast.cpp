#include "engine/cloud/ray_cast.hpp"

#include <cmath>

namespace palpate {

namespace {

constexpr double kClose = 1e-6;  // relative to the size: a hit
constexpr int kMaxSteps = 2000;

}  // namespace

TracedSurface traced(const AnalyticShape& shape) {
  return {shape.center(), shape.size(), [&shape](const DVec3& p) { return shape.closest(p); }};
}

TracedSurface traced(const TriangleMesh& mesh, const Bounds& bounds) {
  constexpr double kRoom = 1.1;  // a scan may end before its mesh does
  return {bounds.center(), kRoom * bounds.longestSide(), [&mesh](const DVec3& p) { return mesh.closest(p); }};
}

std::optional<RayHit> castRay(const TracedSurface& surface, const Ray& ray) {
  const double scale = glm::length(ray.along);
  const DVec3 direction = ray.along / scale;
  // Bounding sphere of the surface's box.
  const double radius = 0.87 * surface.size;
  const DVec3 toCenter = surface.center - ray.from;
  const double along = glm::dot(toCenter, direction);
  const double rest = radius * radius - (glm::dot(toCenter, toCenter) - along * along);
  if (rest <= 0) return std::nullopt;
  double depth = std::max(0.0, along - std::sqrt(rest));
  const double end = along + std::sqrt(rest);
  for (int step = 0; step < kMaxSteps && depth < end; ++step) {
    const DVec3 place = ray.from + depth * direction;
    const SurfacePoint closest = surface.closest(place);
    const double distance = glm::distance(place, closest.position);
    if (distance < kClose * surface.size) {
      // The remaining distance along the tangent plane. The normal of an edge points at the ray.
      const double slope = glm::dot(closest.normal, direction);
      if (slope < -1e-3) depth += glm::dot(closest.position - place, closest.normal) / slope;
      const SurfacePoint hit = surface.closest(ray.from + (depth + 4 * kClose * surface.size) * direction);
      return RayHit{depth / scale, hit.normal};
    }
    depth += distance;
  }
  return std::nullopt;
}

}  // namespace palpate
