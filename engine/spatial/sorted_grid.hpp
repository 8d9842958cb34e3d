#pragma once

#include <algorithm>
#include <array>

#include "engine/core/bare_vector.hpp"
#include "engine/core/worker_team.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "engine/spatial/neighbour_search.hpp"

namespace palpate {

/// The GPU's hashed grid on the CPU, optimised for speed: points sorted by bucket in two counting passes on several
/// threads, so that a bucket's points are contiguous. The order is CpuHash's with any number of threads; a rebuild for
/// the same number of points does not allocate.
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
  std::size_t bytes() const override;

  const HashGrid& grid() const { return grid_; }
  std::size_t threads() const { return team_.size(); }
  /// The threads that build, available for other work between builds.
  WorkerTeam& team() { return team_; }
  /// All included points in bucket order, stable.
  std::span<const Placed> placed() const { return placed_; }

  /// Calls visit(Placed) for every point strictly nearer than `radius` to `center`, once.
  template <class Visit>
  void forEachNear(const DVec3& center, double radius, Visit&& visit) const;

 private:
  // Low bits of the bucket of a point that is sorted only by the high ones so far.
  using LowBits = std::uint16_t;
  // The range of points that one thread reads, and its next output index for each group of buckets.
  struct Part {
    std::size_t begin = 0, end = 0;
    std::vector<std::uint32_t> next;
  };
  void countGroups(Part& part);
  void placeParts();
  void scatterToGroups(Part& part);
  void sortGroup(std::size_t group);

  // The range in placed_ of a cell's bucket: first and one-past-last index.
  UVec2 bucketRange(const IVec3& cell) const {
    const std::uint32_t bucket = bucketOf(grid_, cell);
    return {starts_[bucket], starts_[bucket + 1]};
  }
  static constexpr std::uint32_t kFewCells = 64;
  template <class Visit>
  void visitFewCells(const CellBox& box, const DVec3& center, double squared, Visit&& visit) const;
  // Visits the near points of a range, without unpredictable branches.
  template <class Visit>
  void visitNear(UVec2 range, const DVec3& center, double squared, Visit&& visit) const;

  HashGrid grid_;
  WorkerTeam team_;
  std::uint32_t lowBits_, groups_;
  bool isThere(std::size_t point) const { return there_.empty() || there_[point]; }

  std::span<const Vec3> positions_;
  std::span<const std::uint8_t> there_;
  std::vector<Part> parts_;
  BareVector<std::uint32_t> keys_;      // bucket of every point
  std::vector<std::uint32_t> grouped_;  // first point of every group of buckets
  BareVector<Placed> halfway_;
  BareVector<LowBits> halfwayLow_;
  BareVector<Placed> placed_;
  std::vector<std::uint32_t> starts_;  // first point of every bucket
};

template <class Visit>
void SortedGrid::visitNear(UVec2 range, const DVec3& center, double squared, Visit&& visit) const {
  constexpr std::uint32_t kBatch = 64;
  std::array<std::uint32_t, kBatch> hits;
  for (std::uint32_t place = range.x; place < range.y;) {
    const std::uint32_t batchEnd = place + std::min(range.y - place, kBatch);
    std::uint32_t count = 0;
    for (; place < batchEnd; ++place) {
      const DVec3 d = DVec3(placed_[place].position) - center;
      hits[count] = place;
      count += glm::dot(d, d) < squared;
    }
    for (std::uint32_t i = 0; i < count; ++i) visit(placed_[hits[i]]);
  }
}

template <class Visit>
void SortedGrid::forEachNear(const DVec3& center, double radius, Visit&& visit) const {
  const CellBox box = cellsAround(grid_, center, radius);
  const double squared = radius * radius;
  if (box.cells() <= kFewCells) {
    visitFewCells(box, center, squared, visit);
  } else if (box.cells() < static_cast<double>(placed_.size())) {
    box.forEach([&](const IVec3& cell) {
      visitNear(bucketRange(cell), center, squared, [&](const Placed& point) {
        if (cellOf(grid_, point.position) == cell) visit(point);
      });
    });
  } else {  // a pass over all points is cheaper
    visitNear({0, static_cast<std::uint32_t>(placed_.size())}, center, squared, visit);
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
    __builtin_prefetch(&placed_[range.x]);
    __builtin_prefetch(&placed_[range.y - 1]);
    ranges[count++] = range;
  });
  for (std::size_t i = 0; i < count; ++i) visitNear(ranges[i], center, squared, visit);
}

}  // namespace palpate
