#include "engine/edit/normal_refit.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/widest_lanes.hpp"
#include "engine/edit/normal_fit.hpp"
#include "shaders/shared/resample.h"

#ifdef PALPATE_AVX512
#include <immintrin.h>
#endif

namespace palpate {

namespace {

struct NearNormals {
  const float *x, *y, *z;
};

// As NormalFit::add() of each in turn, and of the weighted normals. A neighbour without a share has terms of zero,
// which leave every sum as it is.
PALPATE_WIDEST_LANES
void sumsOf(const NearPoints& near, const NearNormals& normals, const Vec3& old, double radius,
            std::array<double, NormalRefit::kTerms>& sums) {
  const float oldX = old.x, oldY = old.y, oldZ = old.z;
  const double inverseRadius = 1.0 / radius, mostSquared = radius * radius;
  std::array<NormalFit::Lanes, NormalRefit::kTerms> to{};
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
  std::ranges::transform(to, sums.begin(), &NormalFit::sumOf);
}

#ifdef PALPATE_AVX512
PALPATE_AVX512 inline double sumOf(__m512d lanes) {
  const __m256d four = _mm512_maskz_extractf64x4_pd(0xf, lanes, 0) + _mm512_maskz_extractf64x4_pd(0xf, lanes, 1);
  const __m128d two = _mm256_castpd256_pd128(four) + _mm256_extractf128_pd(four, 1);
  return two[0] + two[1];
}

// The same bit by bit, with all sums in registers.
PALPATE_AVX512
void sumsOfWide(const NearPoints& near, const NearNormals& normals, const Vec3& old, double radius,
                std::array<double, NormalRefit::kTerms>& sums) {
  static_assert(NormalFit::kLanes == 8);
  const __m256 oldX = _mm256_set1_ps(old.x), oldY = _mm256_set1_ps(old.y), oldZ = _mm256_set1_ps(old.z);
  const __m256 none = _mm256_setzero_ps(), all = _mm256_set1_ps(1), atRightAngle = _mm256_set1_ps(shared::fitShare(0));
  const __m512d inverseRadius = _mm512_set1_pd(1.0 / radius), mostSquared = _mm512_set1_pd(radius * radius);
  const __m512d one = _mm512_set1_pd(1), four = _mm512_set1_pd(4), zero = _mm512_setzero_pd();
  __m512d w0 = zero, wX = zero, wY = zero, wZ = zero, wXX = zero, wYY = zero, wZZ = zero, wXY = zero, wXZ = zero,
          wYZ = zero, sideX = zero, sideY = zero, sideZ = zero, counted = zero;
  for (std::size_t begin = 0; begin < near.size(); begin += NormalFit::kLanes) {
    const auto there =
        static_cast<__mmask8>(0xff >> (NormalFit::kLanes - std::min(NormalFit::kLanes, near.size() - begin)));
    const __m256 nx = _mm256_maskz_loadu_ps(there, normals.x + begin),
                 ny = _mm256_maskz_loadu_ps(there, normals.y + begin),
                 nz = _mm256_maskz_loadu_ps(there, normals.z + begin);
    const __m512d x = _mm512_maskz_loadu_pd(there, near.x() + begin),
                  y = _mm512_maskz_loadu_pd(there, near.y() + begin),
                  z = _mm512_maskz_loadu_pd(there, near.z() + begin);
    const __m256 given =
        _mm256_max_ps(none, _mm256_min_ps(all, atRightAngle + (nx * oldX + ny * oldY + nz * oldZ)));  // fitShare()
    const __m512d squared = x * x + y * y + z * z;
    const __mmask8 within = _mm512_mask_cmp_pd_mask(there, squared, mostSquared, _CMP_LT_OQ);
    const __m512d share = _mm512_maskz_cvtps_pd(within, given);
    const __m512d r = _mm512_sqrt_pd(squared) * inverseRadius, s = one - r, s2 = s * s;
    const __m512d w = share * (s2 * s2 * (four * r + one));  // wendland()
    const __m512d x1 = w * x, y1 = w * y, z1 = w * z;
    w0 += w;
    wX += x1;
    wY += y1;
    wZ += z1;
    wXX += x1 * x;
    wYY += y1 * y;
    wZZ += z1 * z;
    wXY += x1 * y;
    wXZ += x1 * z;
    wYZ += y1 * z;
    sideX += w * _mm512_cvtps_pd(nx);
    sideY += w * _mm512_cvtps_pd(ny);
    sideZ += w * _mm512_cvtps_pd(nz);
    counted += _mm512_maskz_mov_pd(_mm512_cmp_pd_mask(share, zero, _CMP_GT_OQ), one);
  }
  sums = {sumOf(w0),  sumOf(wX),  sumOf(wY),  sumOf(wZ),    sumOf(wXX),   sumOf(wYY),   sumOf(wZZ),
          sumOf(wXY), sumOf(wXZ), sumOf(wYZ), sumOf(sideX), sumOf(sideY), sumOf(sideZ), sumOf(counted)};
}
#endif

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
  std::array<double, kTerms> sums;
  const NearNormals normals{nearX_.data(), nearY_.data(), nearZ_.data()};
#ifdef PALPATE_AVX512
  hasAvx512() ? sumsOfWide(near, normals, old, radius, sums) : sumsOf(near, normals, old, radius, sums);
#else
  sumsOf(near, normals, old, radius, sums);
#endif
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
