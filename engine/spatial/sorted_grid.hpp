#pragma once

#include <array>

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

  void build(std::span<const Vec3> positions) override;
  void move(std::span<const PointMove> moves) override;
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const override;
  std::string_view name() const override { return "sorted grid"; }
  std::size_t bytes() const override;

  const HashGrid& grid() const { return grid_; }
  std::size_t threads() const { return team_.size(); }
  /// The threads that build, free for other work between builds.
  WorkerTeam& team() { return team_; }
  /// All points in bucket order, stable.
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

  // Visits the points of places_ [begin, end) that are near, without a branch that the processor must guess.
  template <class Visit>
  void visitNear(std::uint32_t begin, std::uint32_t end, const DVec3& center, double squared, Visit&& visit) const;
  // True when a cell before `cell` in the box has the same bucket.
  bool cameBefore(const CellBox& box, const IVec3& cell, std::uint32_t bucket) const;

  HashGrid grid_;
  WorkerTeam team_;
  std::uint32_t lowBits_, groups_;
  std::span<const Vec3> positions_;
  std::vector<Part> parts_;
  std::vector<std::uint32_t> keys_;     // bucket of every point
  std::vector<std::uint32_t> grouped_;  // first point of every group of buckets
  std::vector<Placed> halfway_;
  std::vector<LowBits> halfwayLow_;
  std::vector<Placed> placed_;
  std::vector<std::uint32_t> starts_;  // first point of every bucket
};

template <class Visit>
void SortedGrid::visitNear(std::uint32_t begin, std::uint32_t end, const DVec3& center, double squared,
                           Visit&& visit) const {
  constexpr std::uint32_t kBatch = 64;
  std::array<std::uint32_t, kBatch> hits;
  while (begin < end) {
    const std::uint32_t batchEnd = end - begin > kBatch ? begin + kBatch : end;
    std::uint32_t count = 0;
    for (; begin < batchEnd; ++begin) {
      const DVec3 d = DVec3(placed_[begin].position) - center;
      hits[count] = begin;
      count += glm::dot(d, d) < squared;
    }
    for (std::uint32_t i = 0; i < count; ++i) visit(placed_[hits[i]]);
  }
}

template <class Visit>
void SortedGrid::forEachNear(const DVec3& center, double radius, Visit&& visit) const {
  const CellBox box = cellsAround(grid_, center, radius);
  const double squared = radius * radius;
  if (box.cells() > static_cast<double>(placed_.size())) {  // looking at every point is less
    visitNear(0, static_cast<std::uint32_t>(placed_.size()), center, squared, visit);
    return;
  }
  // All buckets first, then their points: memory answers many questions at a time. Two cells may share a bucket, whose
  // points are then looked at once; a small filter of the buckets met so far says when to make sure.
  constexpr std::uint32_t kMostWaiting = 64, kFilterWords = 8, kWordBits = 64;
  std::array<UVec2, kMostWaiting> waiting;
  std::uint32_t waits = 0;
  std::array<std::uint64_t, kFilterWords> met{};
  const auto visitWaiting = [&] {
    for (std::uint32_t i = 0; i < waits; ++i) visitNear(waiting[i].x, waiting[i].y, center, squared, visit);
    waits = 0;
  };
  box.forEachUntil([&](const IVec3& cell) {
    const std::uint32_t bucket = bucketOf(grid_, cell);
    const UVec2 range(starts_[bucket], starts_[bucket + 1]);
    if (range.x == range.y) return true;
    std::uint64_t& word = met[bucket / kWordBits % kFilterWords];
    const std::uint64_t bit = std::uint64_t{1} << (bucket % kWordBits);
    if ((word & bit) != 0 && cameBefore(box, cell, bucket)) return true;
    word |= bit;
    __builtin_prefetch(&placed_[range.x]);
    __builtin_prefetch(&placed_[range.y - 1]);
    waiting[waits++] = range;
    if (waits == kMostWaiting) visitWaiting();
    return true;
  });
  visitWaiting();
}

}  // namespace palpate
