#include "engine/edit/normal_fit.hpp"

#include <algorithm>

#include "shaders/shared/contact.h"

namespace palpate {

NormalFit::Result NormalFit::normal(const DVec3& old) const {
  if (neighbours_ < shared::kMinNeighbours || weights_ <= 0) return {.normal = old};
  const DVec3 mean = sum_ / weights_;
  const SymmetricMatrix3 spread{.xx = squares_.xx / weights_ - mean.x * mean.x,
                                .yy = squares_.yy / weights_ - mean.y * mean.y,
                                .zz = squares_.zz / weights_ - mean.z * mean.z,
                                .xy = squares_.xy / weights_ - mean.x * mean.y,
                                .xz = squares_.xz / weights_ - mean.x * mean.z,
                                .yz = squares_.yz / weights_ - mean.y * mean.z};
  const Eigen3 eigen = eigenSymmetric(spread);
  // Collinear or coincident points have more than one direction of least variance.
  constexpr double kMinGap = 1e-5;
  if (eigen.values[1] - eigen.values[0] <= kMinGap * (eigen.values[2] - eigen.values[0])) return {.normal = old};
  const DVec3 normal = eigen.vectors[0];
  return {.normal = glm::dot(normal, old) < 0 ? -normal : normal,
          .flatness = std::max(0.0, eigen.values[0] / eigen.values[1])};
}

}  // namespace palpate
