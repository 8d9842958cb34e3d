#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/index_options.hpp"
#include "shaders/shared/hash_grid.h"

namespace palpate {

using shared::bucketOf;
using shared::cellOf;
using shared::HashGrid;

/// Number of bits of a bucket number.
std::uint32_t bucketBits(const HashGrid& grid);

/// A grid for `count` points with cells of edge `cell` (model units, positive). About four points share a bucket: on a
/// surface with cells of the support radius that is about one occupied cell per four buckets.
HashGrid makeHashGrid(const Vec3& origin, double cell, std::uint64_t count, BucketKey key = BucketKey::teschner);

/// Whether points in this order seldom share a bucket with the one before, by a sample.
bool isScattered(const HashGrid& grid, std::span<const Vec3> positions);

/// Whether cellOf() of a position is this cell, without rounding down: processors before SSE4.1 have no instruction for
/// it. All numbers are exact in double precision.
inline bool isInCell(const HashGrid& grid, const Vec3& position, const IVec3& cell) {
  const float most = shared::kMaxCellCoordinate;
  const DVec3 scaled(glm::clamp((position - grid.origin) * grid.inverseCell, -most, most)), low(cell), high = low + 1.0;
  return (scaled.x >= low.x) & (scaled.y >= low.y) & (scaled.z >= low.z) & (scaled.x < high.x) & (scaled.y < high.y) &
         (scaled.z < high.z);
}

/// A box of cells, both corners included.
struct CellBox {
  IVec3 low, high;

  /// Number of cells; a double, since it may be very large.
  double cells() const {
    const DVec3 sides = DVec3(high) - DVec3(low) + 1.0;
    return sides.x * sides.y * sides.z;
  }
  /// Calls visit(cell) for every cell, x fastest.
  template <class Visit>
  void forEach(Visit&& visit) const {
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) visit(IVec3(x, y, z));
  }
};

/// Which of the cells around a ball may contain points in it, allowing for single-precision rounding: half of those in
/// its box do not.
class CellBall {
 public:
  CellBall(const HashGrid& grid, const DVec3& center, double radius);

  /// The cells of a row of the box that may contain some: a range of x, its end excluded.
  struct Row {
    int begin, end;
  };
  Row row(int y, int z, const CellBox& box) const {
    const double besideY = beside(y, center_.y), besideZ = beside(z, center_.z);
    const double left = squared_ - besideY * besideY - besideZ * besideZ;
    if (left < 0) return {box.low.x, box.low.x};
    const double half = std::sqrt(left);
    return {std::max(box.low.x, static_cast<int>(std::floor(center_.x - half))),
            std::min(box.high.x, static_cast<int>(std::floor(center_.x + half))) + 1};
  }

 private:
  static double beside(int cell, double center) { return std::max({cell - center, center - cell - 1, 0.0}); }

  DVec3 center_;  // in cells, as the squared radius
  double squared_;
};

/// The cells that may contain points nearer than `radius` to `center`, allowing for single-precision rounding.
CellBox cellsAround(const HashGrid& grid, const DVec3& center, double radius);

}  // namespace palpate
