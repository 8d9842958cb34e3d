#pragma once

#include <algorithm>
#include <array>

#include "engine/cloud/neighbour_search.hpp"
#include "engine/core/bucket_sort.hpp"
#include "engine/spatial/hash_grid.hpp"

namespace palpate {

/// The GPU's hashed grid on the CPU: the same buckets with the same points in the same order, with any number of
/// threads. A rebuild for at most as many points as before does not allocate.
class SortedGrid final : public NeighbourSearch {
 public:
  /// A point in bucket order; its number is its index in the positions.
  struct Placed {
    Vec3 position;
    std::uint32_t number;
  };

  /// `threads`: 0: one per core.
  explicit SortedGrid(const HashGrid& grid, unsigned threads = 0);

  void build(std::span<const Vec3> positions) override { build(positions, {}); }
  /// `there`: zero for each point to leave out; empty: all points are included.
  void build(std::span<const Vec3> positions, std::span<const std::uint8_t> there);
  void move(std::span<const PointMove> moves) override;
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const override;
  std::string_view name() const override { return "sorted grid"; }
  std::size_t bytes() const override { return sort_.bytes(); }

  const HashGrid& grid() const { return grid_; }
  std::size_t threads() const { return team_.size(); }
  /// The threads that build, available for other work between builds.
  WorkerTeam& team() { return team_; }
  /// All included points in bucket order, stable.
  std::span<const Placed> placed() const { return sort_.items(); }
  /// First and one-past-last index in placed() of a bucket.
  UVec2 range(std::uint32_t bucket) const { return {sort_.starts()[bucket], sort_.starts()[bucket + 1]}; }

  /// Calls visit(Placed) for every point strictly nearer than `radius` to `center`, once.
  template <class Visit>
  void forEachNear(const DVec3& center, double radius, Visit&& visit) const;

 private:
  UVec2 bucketRange(const IVec3& cell) const { return range(bucketOf(grid_, cell)); }
  static constexpr std::uint32_t kFewCells = 64;
  template <class Visit>
  void visitFewCells(const CellBox& box, const DVec3& center, double squared, Visit&& visit) const;
  // Visits the near points of a range, without unpredictable branches.
  template <class Visit>
  void visitNear(UVec2 range, const DVec3& center, double squared, Visit&& visit) const;

  HashGrid grid_;
  WorkerTeam team_;
  std::span<const Vec3> positions_;
  std::span<const std::uint8_t> there_;
  BucketSort<Placed> sort_;
};

template <class Visit>
void SortedGrid::visitNear(UVec2 range, const DVec3& center, double squared, Visit&& visit) const {
  constexpr std::uint32_t kBatch = 64;
  const std::span<const Placed> points = placed();
  std::array<std::uint32_t, kBatch> hits;
  for (std::uint32_t place = range.x; place < range.y;) {
    const std::uint32_t batchEnd = place + std::min(range.y - place, kBatch);
    std::uint32_t count = 0;
    for (; place < batchEnd; ++place) {
      const DVec3 d = DVec3(points[place].position) - center;
      hits[count] = place;
      count += glm::dot(d, d) < squared;
    }
    for (std::uint32_t i = 0; i < count; ++i) visit(points[hits[i]]);
  }
}

template <class Visit>
void SortedGrid::forEachNear(const DVec3& center, double radius, Visit&& visit) const {
  const CellBox box = cellsAround(grid_, center, radius);
  const double squared = radius * radius;
  if (box.cells() <= kFewCells) {
    visitFewCells(box, center, squared, visit);
  } else if (box.cells() < static_cast<double>(placed().size())) {
    box.forEach([&](const IVec3& cell) {
      visitNear(bucketRange(cell), center, squared, [&](const Placed& point) {
        if (cellOf(grid_, point.position) == cell) visit(point);
      });
    });
  } else {  // a pass over all points is cheaper
    visitNear({0, static_cast<std::uint32_t>(placed().size())}, center, squared, visit);
  }
}

template <class Visit>
void SortedGrid::visitFewCells(const CellBox& box, const DVec3& center, double squared, Visit&& visit) const {
  // Prefetches all buckets before visiting their points, so that memory accesses overlap. Two cells may share a bucket,
  // whose points are then visited once: cheaper than computing each point's cell.
  std::array<UVec2, kFewCells> ranges;
  std::size_t count = 0;
  box.forEach([&](const IVec3& cell) {
    const UVec2 range = bucketRange(cell);
    if (range.x == range.y || std::find(ranges.begin(), ranges.begin() + count, range) != ranges.begin() + count)
      return;
    __builtin_prefetch(&placed()[range.x]);
    __builtin_prefetch(&placed()[range.y - 1]);
    ranges[count++] = range;
  });
  for (std::size_t i = 0; i < count; ++i) visitNear(ranges[i], center, squared, visit);
}

}  // namespace palpate
