#include "engine/contact/surface_reference.hpp"

#include "shaders/shared/contact.h"

namespace palpate {

SurfaceSample SurfaceSums::sample() const {
  SurfaceSample sample{.neighbours = neighbours_};
  const double length = glm::length(normals_);
  sample.defined = neighbours_ >= shared::kMinNeighbours && weights_ > 0 &&
                   length > static_cast<double>(shared::kLeastNormal) * weights_;
  if (sample.defined) {
    sample.normal = normals_ / length;
    sample.distance = -glm::dot(sample.normal, offsets_) / weights_;
  }
  return sample;
}

double averageSurfaceBias(double radius, double sphereRadius) { return 0.0694 * radius * radius / sphereRadius; }

}  // namespace palpate
