#include "engine/edit/normal_refit.hpp"

#include <array>
#include <cmath>

#include "engine/core/widest_lanes.hpp"
#include "engine/edit/normal_fit.hpp"
#include "shaders/shared/resample.h"

namespace palpate {

namespace {

// One for each sum: weight, offsets, their six products, normals, and 1 for a neighbour with a share.
constexpr std::size_t kTerms = 14;

struct NearNormals {
  const float *x, *y, *z;
};

// As NormalFit::add(), and of the weighted normals; `rows`: kTerms of them, `stride` apart. A neighbour
// without a share has terms of zero, which leave every sum as it is.
PALPATE_WIDEST_LANES
void termsOf(const NearPoints& near, const NearNormals& normals, const Vec3& old, double radius, double* rows,
             std::size_t stride) {
  const float oldX = old.x, oldY = old.y, oldZ = old.z;
  const double inverseRadius = 1.0 / radius, mostSquared = radius * radius;
  const double *nearX = near.x(), *nearY = near.y(), *nearZ = near.z();
  const std::size_t count = near.size();
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const float nx = normals.x[k], ny = normals.y[k], nz = normals.z[k];
    const float given = shared::fitShare(nx * oldX + ny * oldY + nz * oldZ);
    const double x = nearX[k], y = nearY[k], z = nearZ[k];
    const double squared = x * x + y * y + z * z;
    const double share = squared < mostSquared ? double{given} : 0.0;
    const double length = std::sqrt(squared);
    const double w = share * wendland(length * inverseRadius);
    const double root = std::sqrt(w);
    const double rx = root * x, ry = root * y, rz = root * z;
    rows[k] = w;
    rows[stride + k] = w * x;
    rows[2 * stride + k] = w * y;
    rows[3 * stride + k] = w * z;
    rows[4 * stride + k] = rx * rx;
    rows[5 * stride + k] = ry * ry;
    rows[6 * stride + k] = rz * rz;
    rows[7 * stride + k] = rx * ry;
    rows[8 * stride + k] = rx * rz;
    rows[9 * stride + k] = ry * rz;
    rows[10 * stride + k] = w * double{nx};
    rows[11 * stride + k] = w * double{ny};
    rows[12 * stride + k] = w * double{nz};
    rows[13 * stride + k] = share > 0 ? 1 : 0;
  }
}

}  // namespace

void NormalRefit::makeRoom(std::size_t points) {
  if (normalX_.size() >= points) return;
  for (std::vector<float>* each : {&normalX_, &normalY_, &normalZ_, &nearX_, &nearY_, &nearZ_})
    each->resize(2 * points);
  terms_.resize(kTerms * 2 * points);
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
  const std::size_t stride = nearX_.size();
  termsOf(near, {nearX_.data(), nearY_.data(), nearZ_.data()}, old, radius, terms_.data(), stride);
  std::array<double, kTerms> sums{};
  for (std::size_t k = 0; k < near.size(); ++k)
    for (std::size_t term = 0; term < kTerms; ++term) sums[term] += terms_[term * stride + k];
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
