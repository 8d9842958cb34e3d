#include "engine/cloud/even_points.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "engine/cloud/morton.hpp"
#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr std::size_t kEvenCellsAtOnce = 256;  // taken by a thread at a time
constexpr std::size_t kPasses = 8;             // the number of parities of three coordinates

// Distance in cell sides: looking cells up costs more than visiting points, unless all points are visited.
constexpr float kWide = 2, kNarrow = 1;
constexpr float kSameSide = 0.5f;  // minimum cosine of the normals of points on the same face

struct OrientedPoint {
  Vec3 place, normal;
};

/// Points stored by coordinate, so that compilers vectorise comparisons.
class PointLanes {
 public:
  void clear() { blocks_.clear(), count_ = 0; }
  void add(const OrientedPoint& point) {
    if (count_ % kLanes == 0) blocks_.push_back(nowhere());
    Block& block = blocks_.back();
    const std::size_t k = count_++ % kLanes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      block.place[axis][k] = point.place[static_cast<int>(axis)];
      block.normal[axis][k] = point.normal[static_cast<int>(axis)];
    }
  }

  /// The sum of the normals of points nearer than `distance` that are on the same face.
  Vec3 normalsNear(const OrientedPoint& point, float distance) const {
    std::array<Lanes, 3> sums{};
    for (const Block& block : blocks_)
      for (std::size_t k = 0; k < kLanes; ++k) {
        const std::int32_t counts = static_cast<std::int32_t>(block.squaredWay(point, k) < distance * distance) &
                                    static_cast<std::int32_t>(block.cosine(point, k) > kSameSide);
        const auto weight = static_cast<float>(counts);
        for (std::size_t axis = 0; axis < 3; ++axis) sums[axis][k] += weight * block.normal[axis][k];
      }
    Vec3 sum(0);
    for (std::size_t k = 0; k < kLanes; ++k) sum += Vec3(sums[0][k], sums[1][k], sums[2][k]);
    return sum;
  }

 private:
  static constexpr std::size_t kLanes = 8;
  using Lanes = std::array<float, kLanes>;
  struct Block {
    std::array<Lanes, 3> place, normal;

    float squaredWay(const OrientedPoint& point, std::size_t k) const {
      const float x = place[0][k] - point.place.x, y = place[1][k] - point.place.y, z = place[2][k] - point.place.z;
      return x * x + y * y + z * z;
    }
    float cosine(const OrientedPoint& point, std::size_t k) const {
      return normal[0][k] * point.normal.x + normal[1][k] * point.normal.y + normal[2][k] * point.normal.z;
    }
  };
  /// Unused lanes are farther than any distance.
  static Block nowhere() {
    Block block{};
    for (Lanes& places : block.place) places.fill(std::numeric_limits<float>::infinity());
    return block;
  }

  std::vector<Block> blocks_;
  std::size_t count_ = 0;
};

/// Points sorted by grid cells, in their order within a cell.
class GriddedPoints {
 public:
  GriddedPoints(std::span<const Vec3> points, std::span<const Vec3> normals, float distance, float side,
                unsigned threads)
      : distance_(distance), side_(side * distance), threads_(threads) {
    order_ = parallelMake(points.size(), threads, [&](std::size_t i) {
      return Entry{mortonCode(mortonCell(points[i], side_)), static_cast<std::uint32_t>(i)};
    });
    sortByMorton(order_, threads, [](const Entry& entry) { return entry.code; });
    cells_ = MortonCells(order_.size(), threads, [&](std::size_t k) { return order_[k].code; });
    points_ = parallelMake(order_.size(), threads, [&](std::size_t k) {
      return OrientedPoint{points[order_[k].point], normals[order_[k].point]};
    });
  }

  BareVector<std::uint32_t> evenlySpaced() {
    keptOnes_.resize(points_.size());
    keptCounts_ = parallelMake(cells_.count(), threads_, [](std::size_t) { return std::uint32_t{0}; });
    kept_.resize(points_.size());
    for (std::size_t pass = 0; pass < kPasses; ++pass)
      parallelBlocks(cells_.count(), kEvenCellsAtOnce, threads_, [&](std::size_t begin, std::size_t end) {
        std::vector<OrientedPoint> kept;
        for (std::size_t cell = begin; cell < end; ++cell)
          if (cells_.code(cell) % kPasses == pass) chooseIn(cell, kept);
      });
    return chosen();
  }

  BareVector<std::uint32_t> inCompany(std::size_t fewest) {
    kept_.resize(points_.size());
    forEachPoint([&](std::size_t k, const Around& around) { kept_[k] = hasCompany(k, around, fewest); });
    return chosen();
  }

  BareVector<Vec3> smoothedNormals() const {
    BareVector<Vec3> smooth(points_.size());
    parallelBlocks(cells_.count(), kEvenCellsAtOnce, threads_, [&](std::size_t begin, std::size_t end) {
      PointLanes near;
      for (std::size_t cell = begin; cell < end; ++cell) {
        near.clear();
        const Around around = cellsAround(cell);
        for (std::size_t c = 0; c < around.count; ++c)
          for (std::size_t k = cells_.begin(around.cells[c]); k < cells_.end(around.cells[c]); ++k)
            near.add(points_[k]);
        // A point's own normal is included, and all are on its side, so the sum is not zero.
        for (std::size_t k = cells_.begin(cell); k < cells_.end(cell); ++k)
          smooth[order_[k].point] = glm::normalize(near.normalsNear(points_[k], distance_));
      }
    });
    return smooth;
  }

 private:
  struct Entry {
    std::uint64_t code;
    std::uint32_t point;
  };
  struct Around {
    std::array<std::uint32_t, 27> cells;
    std::size_t count = 0;
  };
  /// The cell itself first: most near points are in it.
  Around cellsAround(std::size_t cell) const {
    Around around;
    around.cells[around.count++] = static_cast<std::uint32_t>(cell);
    cells_.forEachAround(mortonCellOf(cells_.code(cell)), [&](std::uint32_t near) {
      if (near != cell) around.cells[around.count++] = near;
    });
    return around;
  }

  template <class Use>
  void forEachPoint(Use&& use) const {
    parallelBlocks(cells_.count(), kEvenCellsAtOnce, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t cell = begin; cell < end; ++cell) {
        const Around around = cellsAround(cell);
        for (std::size_t k = cells_.begin(cell); k < cells_.end(cell); ++k) use(k, around);
      }
    });
  }

  /// Calls use(other) for the points nearer than the distance, including the point itself, until it returns true.
  template <class Use>
  void forNear(std::size_t point, const Around& around, Use&& use) const {
    const Vec3 place = points_[point].place;
    for (std::size_t c = 0; c < around.count; ++c)
      for (std::size_t k = cells_.begin(around.cells[c]); k < cells_.end(around.cells[c]); ++k) {
        const Vec3 way = points_[k].place - place;
        if (glm::dot(way, way) < distance_ * distance_ && use(k)) return;
      }
  }

  void chooseIn(std::size_t cell, std::vector<OrientedPoint>& kept) {
    kept.clear();
    const Around around = cellsAround(cell);
    for (std::size_t c = 0; c < around.count; ++c) {
      const auto first = keptOnes_.begin() + static_cast<std::ptrdiff_t>(cells_.begin(around.cells[c]));
      kept.insert(kept.end(), first, first + keptCounts_[around.cells[c]]);
    }
    const std::size_t before = kept.size();
    for (std::size_t k = cells_.begin(cell); k < cells_.end(cell); ++k) {
      kept_[k] = isFree(points_[k], kept);
      if (kept_[k]) kept.push_back(points_[k]);
    }
    std::copy(kept.begin() + static_cast<std::ptrdiff_t>(before), kept.end(), &keptOnes_[cells_.begin(cell)]);
    keptCounts_[cell] = static_cast<std::uint32_t>(kept.size() - before);
  }

  bool isFree(const OrientedPoint& point, std::span<const OrientedPoint> kept) const {
    return std::ranges::none_of(kept, [&](const OrientedPoint& other) {
      const Vec3 way = other.place - point.place;
      return glm::dot(way, way) < distance_ * distance_ && glm::dot(point.normal, other.normal) >= 0;
    });
  }

  bool hasCompany(std::size_t point, const Around& around, std::size_t fewest) const {
    std::size_t found = 0;
    forNear(point, around, [&](std::size_t other) {
      if (other != point && glm::dot(points_[point].normal, points_[other].normal) > kSameSide) ++found;
      return found >= fewest;
    });
    return found >= fewest;
  }

  BareVector<std::uint32_t> chosen() const {
    BareVector<std::uint8_t> isChosen(kept_.size());
    parallelFor(kept_.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) isChosen[order_[k].point] = kept_[k];
    });
    return parallelCollect(
        isChosen.size(), threads_, [&](std::size_t i) { return isChosen[i] != 0; },
        [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  }

  float distance_, side_;  // of a cell
  unsigned threads_;
  BareVector<Entry> order_;           // sorted by cell
  BareVector<OrientedPoint> points_;  // in that order
  MortonCells cells_;
  BareVector<std::uint8_t> kept_;         // in the order of the cells
  BareVector<OrientedPoint> keptOnes_;    // kept points of each cell, starting at the cell's first index
  BareVector<std::uint32_t> keptCounts_;  // kept points in each cell
};

}  // namespace

BareVector<std::uint32_t> evenlySpaced(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                       unsigned threads) {
  PALPATE_CHECK_EQ(points.size(), normals.size());
  PALPATE_CHECK_LT(0.0f, distance);
  return GriddedPoints(points, normals, distance, kWide, threads).evenlySpaced();
}

BareVector<std::uint32_t> inCompany(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                    std::size_t fewest, unsigned threads) {
  PALPATE_CHECK_EQ(points.size(), normals.size());
  PALPATE_CHECK_LT(0.0f, distance);
  return GriddedPoints(points, normals, distance, kWide, threads).inCompany(fewest);
}

BareVector<Vec3> smoothedNormals(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                 unsigned threads) {
  PALPATE_CHECK_EQ(points.size(), normals.size());
  PALPATE_CHECK_LT(0.0f, distance);
  return GriddedPoints(points, normals, distance, kNarrow, threads).smoothedNormals();
}

}  // namespace palpate
