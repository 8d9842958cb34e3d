#pragma once

#include <algorithm>
#include <array>
#include <atomic>

#include "engine/cloud/neighbour_search.hpp"
#include "engine/core/bucket_sort.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "engine/spatial/spare_blocks.hpp"

namespace palpate {

/// The GPU's hashed grid on the CPU: the same buckets with the same points in the same order, with any number of
/// threads. A rebuild for at most as many points as before does not allocate. An update costs the changed points and
/// the buckets that they enter or leave, and leaves the buckets that a build would make: queries visit the same points
/// in the same order.
class SortedGrid {
 public:
  /// A point in bucket order; its number is its index in the positions.
  struct Placed {
    Vec3 position;
    std::uint32_t number;
  };

  /// On: a build takes one more pass over the points, and a search in a wide ball skips buckets that contain only
  /// points of cells outside it.
  enum class CellTags { off, on };
  /// `threads`: 0: one per core.
  explicit SortedGrid(const HashGrid& grid, unsigned threads = 0, CellTags cellTags = CellTags::off);

  void build(std::span<const Vec3> positions) { build(positions, {}); }
  /// `there`: zero for each point to leave out; empty: all points are included.
  void build(std::span<const Vec3> positions, std::span<const std::uint8_t> there);
  /// Follows the points with the numbers in `changed`, each once: moved, removed, restored or appended to the
  /// positions. All other points are as at the last build or update.
  void update(std::span<const Vec3> positions, std::span<const std::uint8_t> there,
              std::span<const std::uint32_t> changed);
  void move(std::span<const PointMove> moves);
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const;
  std::string_view name() const { return "sorted grid"; }
  std::size_t bytes() const;

  const HashGrid& grid() const { return grid_; }
  std::size_t threads() const { return team_.size(); }
  /// The threads that build, available for other work between builds.
  WorkerTeam& team() { return team_; }
  /// Number of included points.
  std::size_t size() const { return size_; }
  /// The points of a bucket, by number.
  std::span<const Placed> bucket(std::uint32_t bucket) const {
    return {at(buckets_[bucket].begin), buckets_[bucket].count};
  }
  /// Until the first update after a build: all included points in bucket order, stable.
  std::span<const Placed> placed() const {
    PALPATE_CHECK(isFresh_);
    return sort_.items();
  }
  /// First and one-past-last index in placed() of a bucket.
  UVec2 range(std::uint32_t bucket) const { return {sort_.starts()[bucket], sort_.starts()[bucket + 1]}; }
  /// Number of builds so far.
  std::uint64_t builds() const { return builds_; }
  /// Number of points that updates have written or moved so far.
  std::uint64_t written() const { return written_; }

  /// Calls visit(Placed) for every point strictly nearer than `radius` to `center`, once.
  template <class Visit>
  void forEachNear(const DVec3& center, double radius, Visit&& visit) const {
    forEachNearWhile(center, radius, visit, [](std::size_t) { return true; });
  }
  /// The same as long as goesOn(n) allows it to look at n more points or cells, a few at a time; false if it did not.
  template <class Visit, class GoesOn>
  bool forEachNearWhile(const DVec3& center, double radius, Visit&& visit, GoesOn&& goesOn) const;
  /// The same for an even share of these points, at the cost of the cells around and of at most `most` points: one in
  /// so many as it returns. Where that is 1, all are visited.
  template <class Visit>
  std::size_t sampleNear(const DVec3& center, double radius, std::size_t most, Visit&& visit) const;
  /// The same in slices, for several threads: the points of slice 0, then those of 1 and so on are those of
  /// forEachNear() in its order.
  std::size_t slices(const DVec3& center, double radius) const;
  template <class Visit>
  void forEachNear(const DVec3& center, double radius, std::size_t slice, Visit&& visit) const;

  /// The most cells of a box whose buckets are visited whole.
  static constexpr std::uint32_t kFewCells = 64;
  /// Calls visit(points) for the buckets of a box of at most kFewCells cells, each once, in the order in which
  /// forEachNear() visits them for a ball with this box.
  template <class Visit>
  void forEachBucket(const CellBox& box, Visit&& visit) const;

 private:
  // Slots: those of the last build, then the spare ones.
  struct Bucket {
    std::uint32_t begin = 0, count = 0;
  };
  // A point that enters or leaves a bucket.
  struct Transfer {
    std::uint32_t bucket, number;
    bool enters;
  };

  // After the end of the build's slots, where its last buckets may begin if they are empty.
  std::uint32_t firstSpare() const { return static_cast<std::uint32_t>(sort_.items().size()) + 1; }
  const Placed* at(std::uint32_t slot) const {
    return slot < firstSpare() ? sort_.items().data() + slot : spare_.at(slot - firstSpare());
  }
  Placed* at(std::uint32_t slot) {
    return slot < firstSpare() ? sort_.items().data() + slot : spare_.at(slot - firstSpare());
  }
  std::uint32_t homeSlots(std::uint32_t bucket) const { return sort_.starts()[bucket + 1] - sort_.starts()[bucket]; }
  std::uint32_t slots(std::uint32_t bucket) const;
  // The numbers that one thread follows at a time, and those of their points that enter or leave a bucket.
  struct Followed {
    std::vector<Transfer> transfers;
    std::uint64_t written = 0;
  };
  static constexpr std::size_t kFollowed = 64;
  void follow(std::span<const std::uint32_t> changed, Followed& followed);
  bool replace(std::uint32_t bucket, std::uint32_t number, const IVec3& cell);
  void transfer(std::span<const Transfer> transfers);
  void leave(Bucket& bucket, std::span<const Transfer> transfers);
  void enter(Bucket& bucket, std::span<const Transfer> transfers, std::uint32_t entering);
  void moveTo(std::uint32_t bucket, std::uint32_t slot);
  void shrink(std::uint32_t bucket);

  static constexpr std::size_t kMaxSide = 2048;
  static constexpr std::size_t kSliceRows = 4;  // rows of cells in a slice
  static std::size_t slicesOfLayer(const CellBox& box) {
    return static_cast<std::size_t>(box.high.y - box.low.y) / kSliceRows + 1;
  }
  bool hasManyCells(const CellBox& box) const {
    return box.cells() > kFewCells && box.cells() < static_cast<double>(size_);
  }
  // A bucket has a bit for each cell of its points; two cells may have the same. Bits of cells that its points have
  // left stay until it is empty.
  static std::uint8_t tagOf(const IVec3& cell) { return static_cast<std::uint8_t>(1u << (tagHash(cell) >> 29)); }
  // Wide balls skip blocks of 4x4x4 cells without a point. A block stays marked until the next build.
  static constexpr int kBlock = 2;  // log2 of its side
  void mark(const IVec3& cell) {
    const std::atomic_ref block(blocks_[bucketOf(grid_, cell >> kBlock) & blockMask_]);
    if (!block.load(std::memory_order_relaxed)) block.store(1, std::memory_order_relaxed);
  }
  static std::uint32_t tagHash(const IVec3& cell) {
    const UVec3 c(cell);
    return c.x * 0x9e3779b1u + c.y * 0x85ebca77u + c.z * 0xc2b2ae3du;
  }
  // Most are tagged already: what threads share is then only read.
  void tag(std::uint32_t bucket, const IVec3& cell) {
    const std::atomic_ref tags(tags_[bucket]);
    if ((tags.load(std::memory_order_relaxed) & tagOf(cell)) == 0)
      tags.fetch_or(tagOf(cell), std::memory_order_relaxed);
    mark(cell);
  }
  std::uint8_t tagsOf(std::span<const Placed> points);
  // Into the cache, as far as it is worth it.
  static void fetch(std::span<const Placed> points) {
    constexpr std::size_t kLine = 64 / sizeof(Placed), kMaxFetched = 8 * kLine;
    for (std::size_t i = 0; i < std::min(points.size(), kMaxFetched); i += kLine) __builtin_prefetch(&points[i]);
    if (!points.empty()) __builtin_prefetch(&points.back());
  }
  // As forEachNearWhile().
  template <class Visit, class GoesOn>
  bool visitCells(const CellBox& box, const DVec3& center, double radius, Visit&& visit, GoesOn&& goesOn) const;
  // Visits the near ones of some points, without unpredictable branches.
  template <class Visit, class GoesOn>
  static bool visitNear(std::span<const Placed> points, const DVec3& center, double squared, Visit&& visit,
                        GoesOn&& goesOn);

  HashGrid grid_;
  WorkerTeam team_;
  std::span<const Vec3> positions_;
  std::span<const std::uint8_t> there_;
  BucketSort<Placed> sort_;  // its keys follow updates
  BareVector<Bucket> buckets_;
  CellTags cellTags_;
  std::vector<std::uint8_t> tags_;  // by bucket
  std::uint32_t blockMask_;
  std::vector<std::uint8_t> blocks_;  // by hash of a block: whether it may contain points
  SpareBlocks<Placed> spare_;
  std::size_t size_ = 0;
  bool isFresh_ = true;
  std::uint64_t builds_ = 0, written_ = 0;
  std::vector<Followed> followed_;   // by part of an update
  std::vector<Transfer> transfers_;  // of an update
};

template <class Visit, class GoesOn>
bool SortedGrid::visitNear(std::span<const Placed> points, const DVec3& center, double squared, Visit&& visit,
                           GoesOn&& goesOn) {
  constexpr std::size_t kBatch = 64;
  std::array<std::uint32_t, kBatch> hits;
  for (std::size_t begin = 0; begin < points.size(); begin += kBatch) {
    const Placed* const batch = points.data() + begin;
    const auto size = static_cast<std::uint32_t>(std::min(points.size() - begin, kBatch));
    if (!goesOn(size)) return false;
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      const DVec3 d = DVec3(batch[i].position) - center;
      hits[count] = i;
      count += glm::dot(d, d) < squared;
    }
    for (std::uint32_t i = 0; i < count; ++i) visit(batch[hits[i]]);
  }
  return true;
}

template <class Visit, class GoesOn>
bool SortedGrid::forEachNearWhile(const DVec3& center, double radius, Visit&& visit, GoesOn&& goesOn) const {
  const CellBox box = cellsAround(grid_, center, radius);
  const double squared = radius * radius;
  bool all = true;
  if (box.cells() <= kFewCells) {
    forEachBucket(
        box, [&](std::span<const Placed> points) { all = all && visitNear(points, center, squared, visit, goesOn); });
  } else if (hasManyCells(box)) {
    return visitCells(box, center, radius, visit, goesOn);
  } else {  // a pass over all points is cheaper
    for (std::uint32_t b = 0; all && b <= grid_.bucketMask; ++b)
      all = visitNear(bucket(b), center, squared, visit, goesOn);
  }
  return all;
}

template <class Visit>
std::size_t SortedGrid::sampleNear(const DVec3& center, double radius, std::size_t most, Visit&& visit) const {
  const CellBox box = cellsAround(grid_, center, radius);
  const CellBall ball(grid_, center, radius);
  const auto forEachCell = [&](auto&& take) {
    for (int z = box.low.z; z <= box.high.z; ++z)
      for (int y = box.low.y; y <= box.high.y; ++y) {
        const auto [begin, end] = ball.row(y, z, box);
        for (int x = begin; x < end; ++x) {
          const IVec3 cell(x, y, z);
          const std::uint32_t number = bucketOf(grid_, cell);
          if (tags_[number] & tagOf(cell)) take(cell, bucket(number));
        }
      }
  };
  std::size_t points = 0;
  forEachCell([&](const IVec3&, std::span<const Placed> placed) { points += placed.size(); });
  const std::size_t step = std::max<std::size_t>(1, (points + most - 1) / most);
  std::size_t next = 0;  // across buckets, so that small ones have their share
  forEachCell([&](const IVec3& cell, std::span<const Placed> placed) {
    for (; next < placed.size(); next += step) {
      const Placed& point = placed[next];
      const DVec3 d = DVec3(point.position) - center;
      if (glm::dot(d, d) < radius * radius && isInCell(grid_, point.position, cell)) visit(point);
    }
    next -= placed.size();
  });
  return step;
}

inline std::size_t SortedGrid::slices(const DVec3& center, double radius) const {
  const CellBox box = cellsAround(grid_, center, radius);
  return hasManyCells(box) ? (static_cast<std::size_t>(box.high.z - box.low.z) + 1) * slicesOfLayer(box) : 1;
}

template <class Visit>
void SortedGrid::forEachNear(const DVec3& center, double radius, std::size_t slice, Visit&& visit) const {
  CellBox box = cellsAround(grid_, center, radius);
  if (!hasManyCells(box)) return forEachNear(center, radius, visit);
  const std::size_t inLayer = slicesOfLayer(box);
  box.low.z = box.high.z = box.low.z + static_cast<int>(slice / inLayer);
  box.low.y += static_cast<int>(slice % inLayer * kSliceRows);
  box.high.y = std::min(box.high.y, box.low.y + static_cast<int>(kSliceRows) - 1);
  visitCells(box, center, radius, visit, [](std::size_t) { return true; });
}

// In batches, whose memory accesses overlap: most cells of a wide ball are empty, and each bucket is a cache miss.
template <class Visit, class GoesOn>
bool SortedGrid::visitCells(const CellBox& box, const DVec3& center, double radius, Visit&& visit,
                            GoesOn&& goesOn) const {
  constexpr std::size_t kBatch = 128, kAhead = 8;
  const CellBall ball(grid_, center, radius);
  std::array<IVec3, kBatch> cells;
  std::array<std::uint32_t, kBatch> numbers;  // of their buckets
  std::size_t count = 0;
  const auto visitBatch = [&] {
    bool all = goesOn(count);
    std::size_t tagged = 0;
    for (std::size_t i = 0; i < count; ++i) {  // without unpredictable branches
      const IVec3 cell = cells[tagged] = cells[i];
      const std::uint32_t number = numbers[tagged] = numbers[i];
      tagged += (tags_[number] & tagOf(cell)) != 0;
    }
    for (std::size_t i = 0; i < tagged; ++i) __builtin_prefetch(&buckets_[numbers[i]]);
    for (std::size_t i = 0; all && i < tagged + kAhead; ++i) {
      if (i < tagged) fetch(bucket(numbers[i]));
      if (i < kAhead) continue;
      const IVec3& cell = cells[i - kAhead];
      const auto visitOwn = [&](const Placed& point) {
        if (isInCell(grid_, point.position, cell)) visit(point);
      };
      all = visitNear(bucket(numbers[i - kAhead]), center, radius * radius, visitOwn, goesOn);
    }
    count = 0;
    return all;
  };
  // The number of a bucket is the exclusive or of those of its coordinates.
  std::array<std::uint32_t, kMaxSide> columns;
  PALPATE_CHECK_LT(box.high.x - box.low.x, static_cast<int>(kMaxSide));
  for (int x = box.low.x; x <= box.high.x; ++x)
    columns[static_cast<std::size_t>(x - box.low.x)] = bucketOf(grid_, {x, 0, 0});
  for (int z = box.low.z; z <= box.high.z; ++z)
    for (int y = box.low.y; y <= box.high.y; ++y) {
      const auto [begin, end] = ball.row(y, z, box);
      const std::uint32_t row = bucketOf(grid_, {0, y, z});
      const std::uint32_t blockRow = bucketOf(grid_, {0, y >> kBlock, z >> kBlock});
      for (int x = begin; x < end; ++x) {
        constexpr int kLast = (1 << kBlock) - 1;
        if ((x == begin || (x & kLast) == 0) &&
            !blocks_[(bucketOf(grid_, {x >> kBlock, 0, 0}) ^ blockRow) & blockMask_]) {
          x |= kLast;
          continue;
        }
        const std::uint32_t number = columns[static_cast<std::size_t>(x - box.low.x)] ^ row;
        cells[count] = {x, y, z};
        numbers[count] = number;
        __builtin_prefetch(&tags_[number]);
        if (++count == kBatch && !visitBatch()) return false;
      }
    }
  return visitBatch();
}

template <class Visit>
void SortedGrid::forEachBucket(const CellBox& box, Visit&& visit) const {
  // Prefetches all buckets before visiting their points, so that memory accesses overlap. Two cells may share a bucket,
  // whose points are then visited once: cheaper than computing each point's cell.
  std::array<std::uint32_t, kFewCells> begins;
  std::array<std::span<const Placed>, kFewCells> visited;
  std::size_t count = 0;
  box.forEach([&](const IVec3& cell) {
    const Bucket& found = buckets_[bucketOf(grid_, cell)];
    if (found.count == 0 || std::find(begins.begin(), begins.begin() + count, found.begin) != begins.begin() + count)
      return;
    begins[count] = found.begin;
    visited[count] = {at(found.begin), found.count};
    fetch(visited[count++]);
  });
  for (std::size_t i = 0; i < count; ++i) visit(visited[i]);
}

}  // namespace palpate
