#pragma once

#include <span>
#include <vector>

#include "engine/spatial/hash_grid.hpp"

namespace palpate {

/// The spatial hash on the CPU, simple and exact: the reference for the GPU's. Same grid, same buckets, same stable
/// order.
class CpuHash {
 public:
  /// Keeps a reference to `positions`; rebuild() after they have moved.
  CpuHash(std::span<const Vec3> positions, const HashGrid& grid);
  void rebuild();

  const HashGrid& grid() const { return grid_; }
  /// Point numbers in bucket order, stable.
  std::span<const std::uint32_t> order() const { return order_; }
  /// First and one-past-last index in order() of a bucket.
  UVec2 range(std::uint32_t bucket) const { return {starts_[bucket], starts_[bucket + 1]}; }

  /// Calls visit(point number) for every point nearer than `radius` to `center`, once, in the order of cells and
  /// order().
  template <class Visit>
  void forEachNear(const DVec3& center, double radius, Visit&& visit) const {
    cellsAround(grid_, center, radius).forEach([&](const IVec3& cell) {
      const UVec2 places = range(bucketOf(grid_, cell));
      for (std::uint32_t place = places.x; place < places.y; ++place) {
        const Vec3& position = positions_[order_[place]];
        const DVec3 d = DVec3(position) - center;
        if (glm::dot(d, d) < radius * radius && cellOf(grid_, position) == cell) visit(order_[place]);
      }
    });
  }

 private:
  std::span<const Vec3> positions_;
  HashGrid grid_;
  std::vector<std::uint32_t> starts_, order_;
};

}  // namespace palpate
