#include "engine/edit/normal_refit.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/widest_lanes.hpp"
#include "engine/edit/normal_fit.hpp"
#include "shaders/shared/resample.h"

namespace palpate {

namespace {

struct NearNormals {
  const float *x, *y, *z;
};

// As NormalFit::add() of each in turn, and of the weighted normals. A neighbour without a share has terms of zero,
// which leave every sum as it is.
PALPATE_WIDEST_LANES
void sumsOf(const NearPoints& near, const NearNormals& normals, const Vec3& old, double radius,
            NormalRefit::Sums& sums) {
  const float oldX = old.x, oldY = old.y, oldZ = old.z;
  const double inverseRadius = 1.0 / radius, mostSquared = radius * radius;
  NormalRefit::Sums to{};
  for (std::size_t begin = 0; begin < near.size(); begin += NormalFit::kLanes) {
    const double *nearX = near.x() + begin, *nearY = near.y() + begin, *nearZ = near.z() + begin;
    const float *normalX = normals.x + begin, *normalY = normals.y + begin, *normalZ = normals.z + begin;
    const std::size_t left = near.size() - begin;
#pragma GCC ivdep
    for (std::size_t lane = 0; lane < NormalFit::kLanes; ++lane) {
      const float nx = normalX[lane], ny = normalY[lane], nz = normalZ[lane];
      const float given = shared::fitShare(nx * oldX + ny * oldY + nz * oldZ);
      const double x = nearX[lane], y = nearY[lane], z = nearZ[lane];
      const double squared = x * x + y * y + z * z;
      const double share = (lane < left) & (squared < mostSquared) ? double{given} : 0.0;
      const double w = share * wendland(std::sqrt(squared) * inverseRadius);
      const double wx = w * x, wy = w * y, wz = w * z;
      to[0][lane] += w;
      to[1][lane] += wx;
      to[2][lane] += wy;
      to[3][lane] += wz;
      to[4][lane] += wx * x;
      to[5][lane] += wy * y;
      to[6][lane] += wz * z;
      to[7][lane] += wx * y;
      to[8][lane] += wx * z;
      to[9][lane] += wy * z;
      to[10][lane] += w * double{nx};
      to[11][lane] += w * double{ny};
      to[12][lane] += w * double{nz};
      to[13][lane] += share > 0 ? 1.0 : 0.0;
    }
  }
  sums = to;
}

}  // namespace

void NormalRefit::makeRoom(std::size_t points) {
  points += NormalFit::kLanes;  // read whole
  if (normalX_.size() >= points) return;
  for (std::vector<float>* each : {&normalX_, &normalY_, &normalZ_, &nearX_, &nearY_, &nearZ_})
    each->resize(2 * points);
}

void NormalRefit::gather(const GatheredPoints& points, std::span<const Vec3> normals) {
  const std::span<const std::uint32_t> numbers = points.numbers();
  makeRoom(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Vec3& normal = normals[numbers[i]];
    normalX_[i] = normal.x;
    normalY_[i] = normal.y;
    normalZ_[i] = normal.z;
  }
}

void NormalRefit::add(std::uint32_t index, const NearPoints& near, const Vec3& old, double radius) {
  for (std::size_t k = 0; k < near.size(); ++k) {
    const std::uint32_t i = near.indices()[k];
    nearX_[k] = normalX_[i];
    nearY_[k] = normalY_[i];
    nearZ_[k] = normalZ_[i];
  }
  Sums lanes;
  sumsOf(near, {nearX_.data(), nearY_.data(), nearZ_.data()}, old, radius, lanes);
  std::array<double, kTerms> sums;
  std::ranges::transform(lanes, sums.begin(), &NormalFit::sumOf);
  const NormalFit::Sums fit{
      .weights = sums[0],
      .offsets = {sums[1], sums[2], sums[3]},
      .squares = {.xx = sums[4], .yy = sums[5], .zz = sums[6], .xy = sums[7], .xz = sums[8], .yz = sums[9]},
      .neighbours = static_cast<std::uint32_t>(sums[13])};
  spreads_.add(NormalFit::spread(fit));
  added_.push_back({.index = index, .old = DVec3(old), .side = {sums[10], sums[11], sums[12]}});
}

void NormalRefit::solve(std::span<Vec3> normals) {
  spreads_.solve();
  for (std::size_t i = 0; i < added_.size(); ++i) {
    const auto& [index, old, side] = added_[i];
    const DVec3 normal = NormalFit::normal(spreads_[i], old).normal;
    normals[index] = Vec3(glm::dot(normal, side) < 0 ? -normal : normal);
  }
  added_.clear();
  spreads_.clear();
}

}  // namespace palpate
