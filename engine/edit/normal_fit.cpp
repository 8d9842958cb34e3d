#include "engine/edit/normal_fit.hpp"

#include <algorithm>

#include "shaders/shared/contact.h"

namespace palpate {

NormalFit::Sums NormalFit::sums() const {
  std::array<double, std::tuple_size_v<decltype(lanes_)>> sums;
  std::ranges::transform(lanes_, sums.begin(), &sumOf);
  return {.weights = sums[0],
          .offsets = {sums[1], sums[2], sums[3]},
          .squares = {.xx = sums[4], .yy = sums[5], .zz = sums[6], .xy = sums[7], .xz = sums[8], .yz = sums[9]},
          .neighbours = neighbours_};
}

SymmetricMatrix3 NormalFit::spread(const Sums& sums) {
  const auto& [weights, offsets, squares, neighbours] = sums;
  if (neighbours < shared::kMinNeighbours || weights <= 0) return {};
  const DVec3 mean = offsets / weights;
  return {.xx = squares.xx / weights - mean.x * mean.x,
          .yy = squares.yy / weights - mean.y * mean.y,
          .zz = squares.zz / weights - mean.z * mean.z,
          .xy = squares.xy / weights - mean.x * mean.y,
          .xz = squares.xz / weights - mean.x * mean.z,
          .yz = squares.yz / weights - mean.y * mean.z};
}

NormalFit::Result NormalFit::normal(const Eigen3& eigen, const DVec3& old) {
  // Collinear or coincident points have more than one direction of least variance.
  constexpr double kMinGap = 1e-5;
  if (eigen.values[1] - eigen.values[0] <= kMinGap * (eigen.values[2] - eigen.values[0])) return {.normal = old};
  const DVec3 normal = eigen.vectors[0];
  return {.normal = glm::dot(normal, old) < 0 ? -normal : normal,
          .flatness = std::max(0.0, eigen.values[0] / eigen.values[1])};
}

}  // namespace palpate
