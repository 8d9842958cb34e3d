#include "engine/edit/spacing_measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/widest_lanes.hpp"
#include "engine/edit/resampling.hpp"
#include "shaders/shared/weight.h"

namespace palpate {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

struct NearNormals {
  const double *x, *y, *z;
};
struct Terms {
  double *weight, *distance;  // 0, and infinity, for a point of another sheet
  std::uint32_t* sector;
};

PALPATE_WIDEST_LANES
void termsOf(const NearPoints& near, const NearNormals& normals, const Frame3& frame, double radius,
             const Terms& terms) {
  const double *x = near.x(), *y = near.y(), *z = near.z(), *nx = normals.x, *ny = normals.y, *nz = normals.z;
  const double ux = frame.u.x, uy = frame.u.y, uz = frame.u.z, vx = frame.v.x, vy = frame.v.y, vz = frame.v.z,
               wx = frame.n.x, wy = frame.n.y, wz = frame.n.z;
  double *weight = terms.weight, *distance = terms.distance;
  std::uint32_t* sector = terms.sector;
  const std::size_t count = near.size();
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const double length = std::sqrt(x[k] * x[k] + y[k] * y[k] + z[k] * z[k]);
    const double cosine = wx * nx[k] + wy * ny[k] + wz * nz[k];
    const double w = shared::wendland(length / radius);
    weight[k] = cosine > static_cast<double>(shared::kSameSheet) ? w : 0.0;
    distance[k] = cosine > static_cast<double>(shared::kSameSheet) && length > 0 ? length : kFar;
  }
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k)
    sector[k] = shared::sectorOf(static_cast<float>(x[k] * ux + y[k] * uy + z[k] * uz),
                                 static_cast<float>(x[k] * vx + y[k] * vy + z[k] * vz));
}

}  // namespace

void SpacingMeasure::gather(const SortedGrid& grid, const GatheredPoints::Balls& balls, std::span<const Vec3> normals) {
  points_.gather(grid, balls);
  const std::span<const std::uint32_t> numbers = points_.numbers();
  if (normalX_.size() < numbers.size()) {
    for (std::vector<double>* each : {&normalX_, &normalY_, &normalZ_, &nearX_, &nearY_, &nearZ_, &weight_, &distance_})
      each->resize(2 * numbers.size());
    sector_.resize(2 * numbers.size());
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Vec3& normal = normals[numbers[i]];
    normalX_[i] = double{normal.x};
    normalY_[i] = double{normal.y};
    normalZ_[i] = double{normal.z};
  }
}

double SpacingMeasure::at(const DVec3& place, const DVec3& normal, double radius) {
  points_.near(place, radius, near_);
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const std::uint32_t i = near_.indices()[k];
    nearX_[k] = normalX_[i];
    nearY_[k] = normalY_[i];
    nearZ_[k] = normalZ_[i];
  }
  termsOf(near_, {nearX_.data(), nearY_.data(), nearZ_.data()}, frameAround(normal), radius,
          {weight_.data(), distance_.data(), sector_.data()});
  double weights = 0;
  SectorDistances nearest;
  nearest.fill(kFar);
  for (std::size_t k = 0; k < near_.size(); ++k) {
    weights += weight_[k];
    double& inSector = nearest[sector_[k]];
    inSector = std::min(inSector, distance_[k]);
  }
  return std::max(shared::spacingFrom(radius, std::max(weights, static_cast<double>(shared::kMinWeights))),
                  sectorSpacing(nearest));
}

}  // namespace palpate
