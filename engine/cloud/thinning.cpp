#include "engine/cloud/thinning.hpp"

#include <cmath>

#include "engine/cloud/counter_random.hpp"
#include "engine/core/check.hpp"

namespace palpate {

PointCloud thinnedAlong(const PointCloud& cloud, double ratio, std::uint64_t seed) {
  PALPATE_CHECK_LE(1.0, ratio);
  const Bounds box = boundsOf(cloud);
  const double side = box.longestSide();
  int axis = 0;
  while (axis < 2 && box.max[axis] - box.min[axis] < side) ++axis;
  PointCloud thinned;
  thinned.origin = cloud.origin;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double along = side > 0 ? (static_cast<double>(cloud.positions[i][axis]) - box.min[axis]) / side : 0;
    if (randomUnit(seed, i) >= std::pow(ratio, -along)) continue;
    thinned.positions.push_back(cloud.positions[i]);
    if (cloud.hasNormals()) thinned.normals.push_back(cloud.normals[i]);
  }
  return thinned;
}

double shareThatStays(double ratio) { return ratio > 1 ? (1 - 1 / ratio) / std::log(ratio) : 1; }

}  // namespace palpate
