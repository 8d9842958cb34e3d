#include "haptics/surface_walk.hpp"

namespace palpate {
namespace {

// The mean of the neighbours lies within this share of their reach, except at the border of a surface, where they are
// all on one side.
constexpr double kOneSided = 0.35;

/// `v` projected onto the plane across the unit vector `normal`, at unit length.
DVec3 tangent(const DVec3& v, const DVec3& normal) {
  const DVec3 across = v - glm::dot(v, normal) * normal;
  const double length = glm::length(across);
  return length > 1e-9 ? across / length : frameAround(normal).u;
}

}  // namespace

SurfaceSpot settle(const ThinnedCloud& sample, const DVec3& p, const DVec3& facing) {
  constexpr int kRounds = 3;  // each starts nearer to the surface, so that its neighbours surround the foot
  SurfaceSpot spot{.position = p, .normal = facing};
  for (int round = 0; round < kRounds; ++round) {
    const std::optional<LocalPlane> plane = sample.planeNear(spot.position, spot.normal);
    if (!plane) {
      spot.supported = false;
      return spot;
    }
    spot.position -= glm::dot(spot.position - plane->position, plane->normal) * plane->normal;
    spot.normal = plane->normal;
    spot.supported = glm::distance(spot.position, plane->position) <= kOneSided * plane->reach;
  }
  return spot;
}

std::vector<SurfaceSpot> walk(const ThinnedCloud& sample, const SurfaceSpot& start, const DVec3& direction, double step,
                              std::size_t steps) {
  std::vector<SurfaceSpot> spots;
  spots.reserve(steps);
  SurfaceSpot spot = start;
  DVec3 heading = tangent(direction, spot.normal);
  for (std::size_t i = 0; i < steps; ++i) {
    spot = settle(sample, spot.position + step * heading, spot.normal);
    heading = tangent(heading, spot.normal);
    spots.push_back(spot);
  }
  return spots;
}

}  // namespace palpate
