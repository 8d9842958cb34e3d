#pragma once

#include <algorithm>
#include <array>

#include "engine/core/bare_vector.hpp"
#include "engine/core/worker_team.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "engine/spatial/neighbour_search.hpp"

namespace palpate {

/// The hashed grid of the GPU on the CPU, made to be fast: points sorted by bucket in two counting passes on several
/// threads, so that a bucket's points lie together. The order is CpuHash's with any number of threads; a rebuild for
/// as many points allocates nothing.
class SortedGrid final : public NeighbourSearch {
 public:
  /// A point where it stands in the order of buckets; its number is its place in the positions.
  struct Placed {
    Vec3 position;
    std::uint32_t number;
  };

  /// `threads`: 0 is one per core.
  explicit SortedGrid(const HashGrid& grid, unsigned threads = 0);

  void build(std::span<const Vec3> positions) override { build(positions, {}); }
  /// `there`: zero for each point that is to be left out; empty when all are in.
  void build(std::span<const Vec3> positions, std::span<const std::uint8_t> there);
  void move(std::span<const PointMove> moves) override;
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const override;
  std::string_view name() const override { return "sorted grid"; }
  std::size_t bytes() const override;

  const HashGrid& grid() const { return grid_; }
  std::size_t threads() const { return team_.size(); }
  /// The threads that build, free for other work between builds.
  WorkerTeam& team() { return team_; }
  /// All points that are there in bucket order, stable.
  std::span<const Placed> placed() const { return placed_; }

  /// Calls visit(Placed) for every point strictly nearer than `radius` to `center`, once.
  template <class Visit>
  void forEachNear(const DVec3& center, double radius, Visit&& visit) const;

 private:
  // A point on its way: sorted by the high bits of its bucket, not yet by the low ones.
  using LowBits = std::uint16_t;
  // The range of points that one thread reads, and where it writes those of each group of buckets.
  struct Part {
    std::size_t begin = 0, end = 0;
    std::vector<std::uint32_t> next;
  };
  void countGroups(Part& part);
  void placeParts();
  void scatterToGroups(Part& part);
  void sortGroup(std::size_t group);

  // Where the points of a cell's bucket stand in placed_: first and one-past-last.
  UVec2 bucketRange(const IVec3& cell) const {
    const std::uint32_t bucket = bucketOf(grid_, cell);
    return {starts_[bucket], starts_[bucket + 1]};
  }
  static constexpr std::uint32_t kFewCells = 64;
  template <class Visit>
  void visitFewCells(const CellBox& box, const DVec3& center, double squared, Visit&& visit) const;
  // Visits the points of a range that are near, without a branch that the processor must guess.
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
  } else {  // a pass over all points costs less
    visitNear({0, static_cast<std::uint32_t>(placed_.size())}, center, squared, visit);
  }
}

template <class Visit>
void SortedGrid::visitFewCells(const CellBox& box, const DVec3& center, double squared, Visit&& visit) const {
  // All buckets first, then their points: memory answers many questions at a time. Two cells may share a bucket, whose
  // points are then visited once, which costs less than asking each of them for its cell.
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
