#include "engine/spatial/gathered_points.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "engine/core/widest_lanes.hpp"

#ifdef PALPATE_AVX512
#include <immintrin.h>

#include <bit>
#endif

namespace palpate {

namespace {

constexpr std::size_t kLanes = 8;  // in which points are searched
constexpr float kFar = std::numeric_limits<float>::infinity();

// Two steps of single precision further.
Vec3 beyond(const DVec3& place, float towards) {
  const auto further = [&](double x) {
    return std::nextafter(std::nextafter(static_cast<float>(x), towards), towards);
  };
  return {further(place.x), further(place.y), further(place.z)};
}

PALPATE_WIDEST_LANES
void squaredDistances(const float* x, const float* y, const float* z, std::size_t count, const DVec3& place,
                      double* squared) {
  const double px = place.x, py = place.y, pz = place.z;
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = double{x[i]} - px, dy = double{y[i]} - py, dz = double{z[i]} - pz;
    squared[i] = dx * dx + dy * dy + dz * dz;
  }
}

using Coordinates = std::array<const float*, 3>;
struct Squares {
  double near, closest;  // of radii
};
struct Counts {
  std::size_t near = 0, closest = 0;
};
struct Into {
  std::uint32_t *index, *closest;
  double *x, *y, *z;
};

Counts search(const Coordinates& from, std::size_t size, const DVec3& place, const Squares& most, double* squared,
              const Into& into) {
  squaredDistances(from[0], from[1], from[2], size, place, squared);
  Counts counts;
  for (std::size_t i = 0; i < size; ++i) {  // without unpredictable branches
    into.index[counts.near] = static_cast<std::uint32_t>(i);
    counts.near += squared[i] < most.near;
  }
  for (std::size_t k = 0; k < counts.near; ++k) {
    const std::uint32_t i = into.index[k];
    into.x[k] = double{from[0][i]} - place.x;
    into.y[k] = double{from[1][i]} - place.y;
    into.z[k] = double{from[2][i]} - place.z;
    into.closest[counts.closest] = i;
    counts.closest += squared[i] < most.closest;
  }
  return counts;
}

#ifdef PALPATE_AVX512
PALPATE_AVX512
Counts searchWide(const Coordinates& from, std::size_t size, const DVec3& place, const Squares& most,
                  const Into& into) {
  const __m512d px = _mm512_set1_pd(place.x), py = _mm512_set1_pd(place.y), pz = _mm512_set1_pd(place.z);
  const __m512d mostNear = _mm512_set1_pd(most.near), mostClosest = _mm512_set1_pd(most.closest);
  __m256i index = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  Counts counts;
  for (std::size_t i = 0; i < size; i += kLanes) {
    const __m512d x = _mm512_sub_pd(_mm512_cvtps_pd(_mm256_loadu_ps(from[0] + i)), px);
    const __m512d y = _mm512_sub_pd(_mm512_cvtps_pd(_mm256_loadu_ps(from[1] + i)), py);
    const __m512d z = _mm512_sub_pd(_mm512_cvtps_pd(_mm256_loadu_ps(from[2] + i)), pz);
    const __m512d far = _mm512_add_pd(_mm512_add_pd(_mm512_mul_pd(x, x), _mm512_mul_pd(y, y)), _mm512_mul_pd(z, z));
    const auto there = static_cast<__mmask8>(0xff >> (kLanes - std::min(kLanes, size - i)));
    const __mmask8 within = _mm512_mask_cmp_pd_mask(there, far, mostNear, _CMP_LT_OQ);
    const __mmask8 close = _mm512_mask_cmp_pd_mask(within, far, mostClosest, _CMP_LT_OQ);
    // Whole registers: to store only some lanes takes long.
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(into.index + counts.near),
                        _mm256_maskz_compress_epi32(within, index));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(into.closest + counts.closest),
                        _mm256_maskz_compress_epi32(close, index));
    _mm512_storeu_pd(into.x + counts.near, _mm512_maskz_compress_pd(within, x));
    _mm512_storeu_pd(into.y + counts.near, _mm512_maskz_compress_pd(within, y));
    _mm512_storeu_pd(into.z + counts.near, _mm512_maskz_compress_pd(within, z));
    counts.near += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(within)));
    counts.closest += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(close)));
    index = _mm256_add_epi32(index, _mm256_set1_epi32(kLanes));
  }
  return counts;
}
#endif

struct GatherInto {
  float *x, *y, *z;
  std::uint32_t* numbers;
};

// Those of the points that are between two corners; returns how many. `into` is written beyond them, by kLanes at most.
std::size_t addBetween(std::span<const SortedGrid::Placed> points, const Vec3& below, const Vec3& above,
                       const GatherInto& into) {
  std::size_t count = 0;
  for (const auto& [place, number] : points) {  // without unpredictable branches
    into.x[count] = place.x;
    into.y[count] = place.y;
    into.z[count] = place.z;
    into.numbers[count] = number;
    count += (place.x < above.x) & (place.y < above.y) & (place.z < above.z) & (place.x > below.x) &
             (place.y > below.y) & (place.z > below.z);
  }
  return count;
}

#ifdef PALPATE_AVX512
PALPATE_AVX512
std::size_t addBetweenWide(std::span<const SortedGrid::Placed> points, const Vec3& below, const Vec3& above,
                           const GatherInto& into) {
  static_assert(sizeof(SortedGrid::Placed) == 4 * sizeof(float));
  const __m512i firstTwo = _mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 1, 5, 9, 13, 17, 21, 25, 29);
  const __m512i lastTwo = _mm512_setr_epi32(2, 6, 10, 14, 18, 22, 26, 30, 3, 7, 11, 15, 19, 23, 27, 31);
  const __m256 lowX = _mm256_set1_ps(below.x), lowY = _mm256_set1_ps(below.y), lowZ = _mm256_set1_ps(below.z);
  const __m256 highX = _mm256_set1_ps(above.x), highY = _mm256_set1_ps(above.y), highZ = _mm256_set1_ps(above.z);
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); i += kLanes) {
    const std::size_t left = std::min(kLanes, points.size() - i);
    const auto mask = (std::uint64_t{1} << 4 * left) - 1;
    const auto* const from = reinterpret_cast<const float*>(points.data() + i);
    const __m512i first = _mm512_maskz_loadu_epi32(static_cast<__mmask16>(mask), from);
    const __m512i second = _mm512_maskz_loadu_epi32(static_cast<__mmask16>(mask >> 16), from + 16);
    const __m512i xy = _mm512_permutex2var_epi32(first, firstTwo, second);
    const __m512i zNumber = _mm512_permutex2var_epi32(first, lastTwo, second);
    const __m256i xs = _mm512_castsi512_si256(xy), ys = _mm512_maskz_extracti64x4_epi64(0xf, xy, 1);
    const __m256i zs = _mm512_castsi512_si256(zNumber), numbers = _mm512_maskz_extracti64x4_epi64(0xf, zNumber, 1);
    const __m256 x = _mm256_castsi256_ps(xs), y = _mm256_castsi256_ps(ys), z = _mm256_castsi256_ps(zs);
    auto within = static_cast<__mmask8>(0xff >> (kLanes - left));
    within = _mm256_mask_cmp_ps_mask(within, x, highX, _CMP_LT_OQ);
    within = _mm256_mask_cmp_ps_mask(within, y, highY, _CMP_LT_OQ);
    within = _mm256_mask_cmp_ps_mask(within, z, highZ, _CMP_LT_OQ);
    within = _mm256_mask_cmp_ps_mask(within, x, lowX, _CMP_GT_OQ);
    within = _mm256_mask_cmp_ps_mask(within, y, lowY, _CMP_GT_OQ);
    within = _mm256_mask_cmp_ps_mask(within, z, lowZ, _CMP_GT_OQ);
    _mm256_storeu_ps(into.x + count, _mm256_maskz_compress_ps(within, x));
    _mm256_storeu_ps(into.y + count, _mm256_maskz_compress_ps(within, y));
    _mm256_storeu_ps(into.z + count, _mm256_maskz_compress_ps(within, z));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(into.numbers + count), _mm256_maskz_compress_epi32(within, numbers));
    count += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(within)));
  }
  return count;
}
#endif

}  // namespace

NearPoints::NearPoints(std::span<const DVec3> offsets) {
  makeRoom(offsets.size());
  for (const DVec3& offset : offsets) {
    index_[count_] = static_cast<std::uint32_t>(count_);
    x_[count_] = offset.x;
    y_[count_] = offset.y;
    z_[count_] = offset.z;
    ++count_;
  }
}

void NearPoints::makeRoom(std::size_t count) {
  count += kLanes;  // written whole
  if (index_.size() >= count) return;
  for (std::vector<std::uint32_t>* each : {&index_, &closest_}) each->resize(2 * count);
  for (std::vector<double>* each : {&x_, &y_, &z_, &squared_}) each->resize(2 * count);
}

void GatheredPoints::makeRoom(std::size_t more) {
  const std::size_t room = count_ + more + kLanes;  // read whole
  if (numbers_.size() >= room) return;
  for (std::vector<float>* each : {&x_, &y_, &z_}) each->resize(room + room / 4);
  numbers_.resize(room + room / 4);
}

void GatheredPoints::gather(const SortedGrid& grid, const Balls& balls) {
  count_ = 0;
  // Leaves out points that are too far along one axis, with a margin for rounding.
  const Vec3 above = beyond(balls.high + balls.radius, kFar), below = beyond(balls.low - balls.radius, -kFar);
  const auto add = [&](std::span<const SortedGrid::Placed> points) {
    makeRoom(points.size());
    const GatherInto into{x_.data() + count_, y_.data() + count_, z_.data() + count_, numbers_.data() + count_};
#ifdef PALPATE_AVX512
    count_ += hasAvx512() ? addBetweenWide(points, below, above, into) : addBetween(points, below, above, into);
#else
    count_ += addBetween(points, below, above, into);
#endif
  };
  if (balls.box.cells() > SortedGrid::kFewCells)
    grid.forEachNear(balls.low, balls.radius, [&](const SortedGrid::Placed& point) { add({&point, 1}); });
  else
    grid.forEachBucket(balls.box, add);
}

void GatheredPoints::near(const DVec3& place, double radius, NearPoints& near, double closest) const {
  near.makeRoom(count_);
  const Squares most{radius * radius, closest * closest};
  const Into into{near.index_.data(), near.closest_.data(), near.x_.data(), near.y_.data(), near.z_.data()};
  const std::array from{x_.data(), y_.data(), z_.data()};
#ifdef PALPATE_AVX512
  const Counts found = hasAvx512() ? searchWide(from, count_, place, most, into)
                                   : search(from, count_, place, most, near.squared_.data(), into);
#else
  const Counts found = search(from, count_, place, most, near.squared_.data(), into);
#endif
  near.count_ = found.near;
  near.closestCount_ = found.closest;
}

void GatheredPoints::near(const DVec3& place, double radius, std::span<const std::uint32_t> among,
                          std::uint32_t without, NearPoints& near) const {
  near.makeRoom(among.size() + 1);
  const double squared = radius * radius;
  std::size_t count = 0;
  for (const std::uint32_t i : among) {
    const double dx = double{x_[i]} - place.x, dy = double{y_[i]} - place.y, dz = double{z_[i]} - place.z;
    near.index_[count] = i;
    near.x_[count] = dx;
    near.y_[count] = dy;
    near.z_[count] = dz;
    count += (dx * dx + dy * dy + dz * dz < squared) & (numbers_[i] != without);
  }
  near.count_ = count;
}

}  // namespace palpate
