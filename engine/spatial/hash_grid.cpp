#include "engine/spatial/hash_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kPointsPerBucket = 4;
constexpr std::uint64_t kFewestBuckets = 1u << 8;
constexpr std::uint64_t kMaxBuckets = 1u << 24;
// Blocks of eight cells a side contain about 64 occupied cells of a surface: a few pages of memory for a whole query.
constexpr std::uint32_t kMortonBlockBits = 3;

// As std::nextafter(value, infinity), without a call: every gather needs six.
float nextAbove(float value) {
  if (!(value < std::numeric_limits<float>::infinity())) return value;
  if (value == 0) return std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return std::bit_cast<float>(value > 0 ? bits + 1 : bits - 1);
}

}  // namespace

std::uint32_t bucketBits(const HashGrid& grid) { return static_cast<std::uint32_t>(std::bit_width(grid.bucketMask)); }

bool isScattered(const HashGrid& grid, std::span<const Vec3> positions) {
  if (positions.size() < 2) return false;
  const std::size_t pairs = std::min<std::size_t>(positions.size() - 1, 4096);
  std::size_t together = 0;
  for (std::size_t k = 0; k < pairs; ++k) {
    const std::size_t i = k * (positions.size() - 1) / pairs;
    together += bucketOf(grid, cellOf(grid, positions[i])) == bucketOf(grid, cellOf(grid, positions[i + 1]));
  }
  return 2 * together < pairs;
}

HashGrid makeHashGrid(const Vec3& origin, double cell, std::uint64_t count, BucketKey key) {
  PALPATE_CHECK_LT(0.0, cell);
  const std::uint64_t buckets = std::clamp(std::bit_ceil(count / kPointsPerBucket), kFewestBuckets, kMaxBuckets);
  return {.origin = origin,
          .inverseCell = static_cast<float>(1.0 / cell),
          .bucketMask = static_cast<std::uint32_t>(buckets - 1),
          .blockBits = key == BucketKey::morton ? kMortonBlockBits : 0};
}

CellBall::CellBall(const HashGrid& grid, const DVec3& center, double radius)
    : center_((center - DVec3(grid.origin)) * static_cast<double>(grid.inverseCell)) {
  const double inCells = radius * static_cast<double>(grid.inverseCell);
  // cellOf() rounds twice, each time by at most half a unit in the last place.
  const double farthest = std::max({std::abs(center_.x), std::abs(center_.y), std::abs(center_.z)}) + inCells;
  const double reach = inCells + 1e-3 + 2 * static_cast<double>(std::numeric_limits<float>::epsilon()) * farthest;
  squared_ = reach * reach;
}

CellBox cellsAround(const HashGrid& grid, const DVec3& center, double radius) {
  // cellOf is monotonic in each coordinate, so corners rounded outwards miss no point.
  Vec3 low(center - radius), high(center + radius);
  for (int k = 0; k < 3; ++k) {
    low[k] = -nextAbove(-low[k]);
    high[k] = nextAbove(high[k]);
  }
  return {cellOf(grid, low), cellOf(grid, high)};
}

}  // namespace palpate
