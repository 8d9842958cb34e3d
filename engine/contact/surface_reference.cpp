#include "engine/contact/surface_reference.hpp"

#include "shaders/shared/contact.h"

namespace palpate {

double wendland(double r) {
  const double s = 1.0 - r;
  return s * s * s * s * (4.0 * r + 1.0);
}

SurfaceSample surfaceAt(const CpuHash& hash, std::span<const Vec3> positions, std::span<const Vec3> normals,
                        const DVec3& x, double radius) {
  DVec3 offsets(0), weightedNormals(0);
  double weights = 0;
  SurfaceSample sample;
  hash.forEachNear(x, radius, [&](std::uint32_t i) {
    const DVec3 d = DVec3(positions[i]) - x;
    const double w = wendland(glm::length(d) / radius);
    offsets += w * d;
    weightedNormals += w * DVec3(normals[i]);
    weights += w;
    ++sample.neighbours;
  });
  const double length = glm::length(weightedNormals);
  sample.defined = sample.neighbours >= shared::kMinNeighbours && weights > 0 &&
                   length > static_cast<double>(shared::kLeastNormal) * weights;
  if (sample.defined) {
    sample.normal = weightedNormals / length;
    sample.distance = -glm::dot(sample.normal, offsets) / weights;
  }
  return sample;
}

double averageSurfaceBias(double radius, double sphereRadius) { return 0.0694 * radius * radius / sphereRadius; }

}  // namespace palpate
