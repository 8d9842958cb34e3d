#include "engine/study/dynamic_tree.hpp"

#include <nanoflann.hpp>

#include <algorithm>
#include <numeric>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr std::size_t kLeafSize = 24;  // as of PointTree

}  // namespace

void MultimapHash::build(std::span<const Vec3> positions) {
  positions_ = positions;
  map_.clear();
  for (std::uint32_t i = 0; i < positions.size(); ++i) map_.emplace(bucketAt(positions[i]), Point{positions[i], i});
}

void MultimapHash::move(std::span<const PointMove> moves) {
  for (const PointMove& move : moves) {
    const auto [first, last] = map_.equal_range(bucketAt(move.from));
    const auto old = std::find_if(first, last, [&](const auto& entry) { return entry.second.number == move.point; });
    PALPATE_CHECK(old != last);
    map_.erase(old);
    const Vec3& to = positions_[move.point];
    map_.emplace(bucketAt(to), Point{to, move.point});
  }
}

void MultimapHash::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  const auto isNear = [&](const Point& point) {
    const DVec3 d = DVec3(point.position) - center;
    return glm::dot(d, d) < radius * radius;
  };
  const CellBox box = cellsAround(grid_, center, radius);
  if (box.cells() > static_cast<double>(map_.size())) {  // a pass over all points is cheaper
    for (const auto& [bucket, point] : map_)
      if (isNear(point)) found.push_back(point.number);
    return;
  }
  box.forEach([&](const IVec3& cell) {
    const auto [first, last] = map_.equal_range(bucketOf(grid_, cell));
    for (auto entry = first; entry != last; ++entry) {
      const Point& point = entry->second;
      if (isNear(point) && cellOf(grid_, point.position) == cell) found.push_back(point.number);
    }
  });
}

std::size_t MultimapHash::bytes() const {
  constexpr std::size_t kLink = sizeof(void*), kBlockHeader = 8, kBlockRounding = 16;
  constexpr std::size_t kEntry = kLink + sizeof(Map::value_type) + kBlockHeader;
  constexpr std::size_t kBlock = (kEntry + kBlockRounding - 1) / kBlockRounding * kBlockRounding;
  return map_.size() * kBlock + map_.bucket_count() * kLink;
}

struct DynamicTree::Index {
  /// The points in the order of their insertion; a moved point is inserted again.
  struct Inserted {
    std::vector<Vec3> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const { return static_cast<double>((&points[i].x)[axis]); }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Metric = nanoflann::L2_Simple_Adaptor<double, Inserted, double, std::uint32_t>;
  using Tree = nanoflann::KDTreeSingleIndexDynamicAdaptor<Metric, Inserted, 3, std::uint32_t>;

  /// Collects the points of a ball by their numbers.
  struct Ball {
    using DistanceType = double;
    using IndexType = std::uint32_t;
    bool addPoint(double squaredDistance, std::uint32_t inserted) {
      if (squaredDistance < squared) found.push_back(numbers[inserted]);
      return true;
    }
    double worstDist() const { return squared * (1 + 1e-9); }  // for pruning, whose sums are rounded
    bool full() const { return true; }

    double squared;
    std::span<const std::uint32_t> numbers;
    std::vector<std::uint32_t>& found;
  };

  explicit Index(std::span<const Vec3> positions)
      : inserted{{positions.begin(), positions.end()}}, numbers(positions.size()), tree(3, inserted, {kLeafSize}) {
    std::iota(numbers.begin(), numbers.end(), 0u);
    places = numbers;
  }

  Inserted inserted;
  std::vector<std::uint32_t> numbers;  // of each inserted point
  std::vector<std::uint32_t> places;   // where each point is among the inserted ones
  Tree tree;
};

DynamicTree::DynamicTree() = default;
DynamicTree::~DynamicTree() = default;

void DynamicTree::build(std::span<const Vec3> positions) {
  positions_ = positions;
  index_.reset();  // first, so that only one exists at a time
  index_ = std::make_unique<Index>(positions);
}

void DynamicTree::move(std::span<const PointMove> moves) {
  if (moves.empty()) return;
  const auto first = static_cast<std::uint32_t>(index_->numbers.size());
  for (const PointMove& move : moves) {
    index_->tree.removePoint(index_->places[move.point]);
    index_->places[move.point] = static_cast<std::uint32_t>(index_->numbers.size());
    index_->numbers.push_back(move.point);
    index_->inserted.points.push_back(positions_[move.point]);
  }
  index_->tree.addPoints(first, static_cast<std::uint32_t>(index_->numbers.size() - 1));
}

void DynamicTree::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  Index::Ball ball{radius * radius, index_->numbers, found};
  index_->tree.findNeighbors(ball, &center.x, {});
}

std::size_t DynamicTree::bytes() const {
  std::size_t bytes = index_->numbers.size() * (sizeof(Vec3) + 2 * sizeof(std::uint32_t) + sizeof(int));
  for (const auto& each : index_->tree.getAllIndices())
    bytes += each.pool.usedMemory + each.pool.wastedMemory + each.vAcc.size() * sizeof(std::uint32_t);
  return bytes;
}

}  // namespace palpate
