#include "engine/cloud/view_normals.hpp"

#include <algorithm>
#include <cmath>

#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr double kViewEdgeOn = 0.2;  // cosine of a plane and its views below which the views do not determine its side
constexpr double kNoPlane = 1e-9;    // of the largest variance: if the middle one is less, the points are on a line

DVec3 unitOr(const DVec3& v, const DVec3& otherwise) {
  const double size = glm::length(v);
  return size > 0 ? v / size : otherwise;
}

/// The position of a normal, and its neighbours.
struct Neighbourhood {
  std::span<const Vec3> points;
  std::span<const PointSight> sights;
  std::span<const std::uint32_t> around;
  std::span<const double> squaredDistances;

  double weightOf(std::size_t k) const {
    const double reach = squaredDistances.back() > 0 ? squaredDistances.back() : 1.0;
    // The farthest neighbour has half the weight of the position itself.
    return sights[around[k]].weight * (1 - 0.5 * squaredDistances[k] / reach);
  }

  Eigen3 spread(const DVec3& center) const {
    DVec3 mean(0);
    double weights = 0;
    for (std::size_t k = 0; k < around.size(); ++k) {
      mean += weightOf(k) * (DVec3(points[around[k]]) - center);
      weights += weightOf(k);
    }
    mean /= weights;
    SymmetricMatrix3 covariance;
    for (std::size_t k = 0; k < around.size(); ++k)
      covariance.addSquare(std::sqrt(weightOf(k) / weights) * (DVec3(points[around[k]]) - center - mean));
    return eigenSymmetric(covariance);
  }

  DVec3 towardsViews() const {
    DVec3 sum(0);
    for (std::size_t k = 0; k < around.size(); ++k)
      sum += weightOf(k) * unitOr(sights[around[k]].towardsViews, DVec3(0));
    return sum;
  }
};

DVec3 normalAt(std::uint32_t i, const Neighbourhood& near) {
  const DVec3 own = near.sights[i].towardsViews;
  const Eigen3 spread = near.spread(DVec3(near.points[i]));
  if (!(spread.values[1] > kNoPlane * spread.values[2]))
    return unitOr(own, unitOr(near.towardsViews(), spread.vectors[0]));
  const DVec3 normal = spread.vectors[0];
  double facing = glm::dot(normal, unitOr(own, DVec3(0)));
  if (std::abs(facing) < kViewEdgeOn) facing = glm::dot(normal, near.towardsViews());
  return facing < 0 ? -normal : normal;
}

}  // namespace

void PointSight::addView(const DVec3& place, const DVec3& eye) { towardsViews += unitOr(eye - place, DVec3(0)); }

void normalsFromViews(PointCloud& cloud, std::span<const PointSight> sights, unsigned neighbours, unsigned threads) {
  PALPATE_CHECK_EQ(sights.size(), cloud.size());
  cloud.normals.resize(cloud.size());
  if (cloud.empty()) return;
  const PointTree tree(cloud.positions, threads);
  const std::size_t count = std::min<std::size_t>(std::max(neighbours, 1u), cloud.size());
  parallelFor(cloud.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> around(count);
    std::vector<double> squaredDistances(count);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t found = tree.nearest(cloud.positions[i], around, squaredDistances);
      PALPATE_CHECK_EQ(found, count);
      const auto point = static_cast<std::uint32_t>(i);
      cloud.normals[i] = Vec3(normalAt(point, {cloud.positions, sights, around, squaredDistances}));
    }
  });
}

std::size_t faceViews(PointCloud& cloud, std::span<const PointSight> sights) {
  PALPATE_CHECK_EQ(sights.size(), cloud.size());
  PALPATE_CHECK_EQ(cloud.normals.size(), cloud.size());
  std::size_t turned = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!(glm::dot(DVec3(cloud.normals[i]), sights[i].towardsViews) < 0)) continue;
    cloud.normals[i] = -cloud.normals[i];
    ++turned;
  }
  return turned;
}

}  // namespace palpate
