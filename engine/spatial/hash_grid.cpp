#include "engine/spatial/hash_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kPointsPerBucket = 4;
constexpr std::uint64_t kFewestBuckets = 1u << 8;
constexpr std::uint64_t kMostBuckets = 1u << 24;

int coordinate(float position, float origin, float inverseCell) {
  const float difference = position - origin;
  const float scaled = difference * inverseCell;
  return static_cast<int>(std::clamp(std::floor(scaled), -shared::kMaxCellCoordinate, shared::kMaxCellCoordinate));
}

}  // namespace

IVec3 cellOf(const HashGrid& grid, const Vec3& position) {
  return {coordinate(position.x, grid.origin.x, grid.inverseCell),
          coordinate(position.y, grid.origin.y, grid.inverseCell),
          coordinate(position.z, grid.origin.z, grid.inverseCell)};
}

std::uint32_t bucketOf(const HashGrid& grid, const IVec3& cell) {
  const UVec3 c(cell);
  return ((c.x * 73856093u) ^ (c.y * 19349663u) ^ (c.z * 83492791u)) & grid.bucketMask;
}

std::uint32_t bucketBits(const HashGrid& grid) { return static_cast<std::uint32_t>(std::bit_width(grid.bucketMask)); }

HashGrid makeHashGrid(const Vec3& origin, double cell, std::uint64_t count) {
  PALPATE_CHECK_LT(0.0, cell);
  const std::uint64_t buckets = std::clamp(std::bit_ceil(count / kPointsPerBucket), kFewestBuckets, kMostBuckets);
  return {.origin = origin,
          .inverseCell = static_cast<float>(1.0 / cell),
          .bucketMask = static_cast<std::uint32_t>(buckets - 1)};
}

}  // namespace palpate
