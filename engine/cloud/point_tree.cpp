#include "engine/cloud/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/check.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/stop_checks.hpp"
#include "engine/core/widest_lanes.hpp"

namespace palpate {
namespace {

constexpr std::size_t kLanes = 8;

// The points of node number `k` of a level begin here.
std::size_t beginOf(std::size_t k, unsigned level, std::size_t points) { return k * points >> level; }

// From a box, which may be a position. Everything in double: squares of float32 would underflow for small models, and
// the centre of a ball is not a point of the cloud.
PALPATE_WIDEST_LANES
void squaredDistancesOf(std::size_t count, const float* x, const float* y, const float* z, const DVec3& low,
                        const DVec3& high, double* squared) {
  const double lowX = low.x, lowY = low.y, lowZ = low.z, highX = high.x, highY = high.y, highZ = high.z;
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const double px = x[i], py = y[i], pz = z[i];
    const double belowX = lowX - px, belowY = lowY - py, belowZ = lowZ - pz;
    const double aboveX = px - highX, aboveY = py - highY, aboveZ = pz - highZ;
    const double overX = belowX > aboveX ? belowX : aboveX, overY = belowY > aboveY ? belowY : aboveY;
    const double overZ = belowZ > aboveZ ? belowZ : aboveZ;
    const double dx = overX > 0 ? overX : 0, dy = overY > 0 ? overY : 0, dz = overZ > 0 ? overZ : 0;
    squared[i] = dx * dx + dy * dy + dz * dz;
  }
}

// Number of values before each, in the order of `values`, and of `indices` where these are equal. `padded`: whole
// lanes; the values beyond `count` are infinite.
PALPATE_WIDEST_LANES
void rankBy(std::size_t count, std::size_t padded, const double* values, const double* indices, std::int64_t* ranks) {
  for (std::size_t i = 0; i < count; ++i) {
    const double value = values[i], index = indices[i];
    std::int64_t before = 0;
    for (std::size_t j = 0; j < padded; ++j)
      before += (values[j] < value) | ((values[j] == value) & (indices[j] < index)) ? 1 : 0;
    ranks[i] = before;
  }
}

std::size_t wholeLanes(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

}  // namespace

struct PointTree::Entry {
  Vec3 position;
  std::uint32_t point;
};

class PointTree::Builder {
 public:
  Builder(std::span<Entry> entries, PointTree& tree) : entries_(entries), boxes_(tree.boxes_), depth_(tree.depth_) {}

  /// Halves the points of a node across its longest side.
  void divide(std::size_t node, unsigned level) {
    const std::size_t k = node - (std::size_t{1} << level), begin = beginOf(k, level, entries_.size());
    const auto part = entries_.subspan(begin, beginOf(k + 1, level, entries_.size()) - begin);
    Box& box = boxes_[node];
    box = {part[0].position, part[0].position};
    for (const Entry& each : part)
      box.low = glm::min(box.low, each.position), box.high = glm::max(box.high, each.position);
    if (level == depth_) return;
    const Vec3 sides = box.high - box.low;
    const int axis = sides.x >= sides.y ? (sides.x >= sides.z ? 0 : 2) : (sides.y >= sides.z ? 1 : 2);
    const auto middle = static_cast<std::ptrdiff_t>(beginOf(2 * k + 1, level + 1, entries_.size()) - begin);
    StopChecks checks;
    std::nth_element(part.begin(), part.begin() + middle, part.end(), [&](const Entry& a, const Entry& b) {
      checks();
      return a.position[axis] < b.position[axis];
    });
  }
  void divideAll(std::size_t node, unsigned level) {
    divide(node, level);
    if (level == depth_) return;
    divideAll(2 * node, level + 1);
    divideAll(2 * node + 1, level + 1);
  }

 private:
  std::span<Entry> entries_;
  std::span<Box> boxes_;
  unsigned depth_;
};

PointTree::PointTree(std::span<const Vec3> points, unsigned threads) { build(points, threads); }

void PointTree::build(std::span<const Vec3> positions, unsigned threads) {
  PALPATE_CHECK_LT(positions.size(), std::size_t{1} << 32);
  points_ = positions;
  if (positions.empty()) return;
  for (depth_ = 0; (positions.size() - 1) >> depth_ >= kLeaf;) ++depth_;
  boxes_.resize(std::size_t{2} << depth_);
  auto entries = parallelMake(positions.size(), threads, [&](std::size_t i) {
    return Entry{positions[i], static_cast<std::uint32_t>(i)};
  });
  Builder builder(entries, *this);
  const unsigned apart = std::min(depth_, 6u);  // from this level on, each node and all below it at once
  for (unsigned level = 0; level <= apart; ++level) {
    const std::size_t nodes = std::size_t{1} << level;
    parallelBlocks(nodes, 1, positions.size() > 4096 ? threads : 1, [&](std::size_t k, std::size_t) {
      if (level < apart) return builder.divide(nodes + k, level);
      builder.divideAll(nodes + k, level);
    });
  }
  order_.resize(positions.size());
  for (auto& axis : coordinates_) axis.assign(positions.size() + kLeaf, 0);
  parallelFor(positions.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      order_[i] = entries[i].point;
      for (int k = 0; k < 3; ++k) coordinates_[static_cast<std::size_t>(k)][i] = entries[i].position[k];
    }
  });
}

void PointTree::move(std::span<const PointMove> moves) {
  if (!moves.empty()) build(points_);
}

inline double PointTree::squaredDistance(const Box& box, const DVec3& p) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double d =
        std::max(std::max(static_cast<double>(box.low[k]) - p[k], p[k] - static_cast<double>(box.high[k])), 0.0);
    sum += d * d;
  }
  return sum;
}

inline double PointTree::squaredDistance(const Box& a, const Box& b) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double over = static_cast<double>(a.low[k]) - static_cast<double>(b.high[k]);
    const double d = std::max(std::max(over, static_cast<double>(b.low[k]) - static_cast<double>(a.high[k])), 0.0);
    sum += d * d;
  }
  return sum;
}

// use(first slot, one past the last) for the leaves no farther from a position or box than `limit`, a squared distance
// that may shrink meanwhile. Distances of boxes are rounded like those of the points in them, and so are never larger.
template <class Place, class Use>
void PointTree::forEachLeaf(const Place& place, const double& limit, Use&& use) const {
  if (points_.empty()) return;
  struct Ahead {
    std::size_t node;
    double squared;
  };
  std::array<Ahead, 33> ahead;
  std::size_t left = 0;
  const std::size_t leaves = std::size_t{1} << depth_;
  for (ahead[left++] = {1, squaredDistance(boxes_[1], place)}; left > 0;) {
    auto [node, nearest] = ahead[--left];
    while (nearest <= limit && node < leaves) {
      const double one = squaredDistance(boxes_[2 * node], place), other = squaredDistance(boxes_[2 * node + 1], place);
      const bool isOther = other < one;
      node = 2 * node + (isOther ? 1 : 0);
      nearest = std::min(one, other);
      const double farther = std::max(one, other);
      if (farther <= limit) ahead[left++] = {node ^ 1, farther};
    }
    if (!(nearest <= limit)) continue;
    use(beginOf(node - leaves, depth_, points_.size()), beginOf(node - leaves + 1, depth_, points_.size()));
  }
}

std::size_t PointTree::nearest(const Vec3& p, std::span<std::uint32_t> indices,
                               std::span<double> squaredDistances) const {
  PALPATE_CHECK_EQ(indices.size(), squaredDistances.size());
  const std::size_t most = indices.size();
  if (most == 0) return 0;
  std::size_t found = 0;
  double limit = std::numeric_limits<double>::max();
  const DVec3 place(p);
  std::array<double, kLeaf> squared;
  forEachLeaf(place, limit, [&](std::size_t begin, std::size_t end) {
    const auto& [x, y, z] = coordinates_;
    squaredDistancesOf(kLeaf, &x[begin], &y[begin], &z[begin], place, place, squared.data());
    for (std::size_t i = begin; i < end; ++i) {
      const double distance = squared[i - begin];
      if (!(distance <= limit)) continue;
      const std::uint32_t index = order_[i];
      const auto isBefore = [&](std::size_t k) {
        return distance < squaredDistances[k] || (distance == squaredDistances[k] && index < indices[k]);
      };
      if (found == most && !isBefore(most - 1)) continue;
      std::size_t k = found < most ? found++ : most - 1;
      for (; k > 0 && isBefore(k - 1); --k) squaredDistances[k] = squaredDistances[k - 1], indices[k] = indices[k - 1];
      squaredDistances[k] = distance, indices[k] = index;
      if (found == most) limit = squaredDistances[most - 1];
    }
  });
  return found;
}

void PointTree::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  const double limit = radius * radius;
  std::array<double, kLeaf> squared;
  forEachLeaf(center, limit, [&](std::size_t begin, std::size_t end) {
    const auto& [x, y, z] = coordinates_;
    squaredDistancesOf(kLeaf, &x[begin], &y[begin], &z[begin], center, center, squared.data());
    for (std::size_t i = begin; i < end; ++i)
      if (squared[i - begin] < limit) found.push_back(order_[i]);
  });
}

std::size_t PointTree::bytes() const {
  return points_.size() * (sizeof(std::uint32_t) + sizeof(Vec3)) + boxes_.size() * sizeof(Box);
}

void NearbySearch::gather(const DVec3& p, std::size_t most) {
  // The squared distances of the last ones of a leaf seldom differ by more.
  const double above = 1 + 2 / std::sqrt(static_cast<double>(most));
  std::size_t node = 1;
  while (node < tree_.boxes_.size() / 2) {
    node *= 2;
    if (PointTree::squaredDistance(tree_.boxes_[node + 1], p) < PointTree::squaredDistance(tree_.boxes_[node], p))
      ++node;
  }
  box_ = tree_.boxes_[node], most_ = most, count_ = 0;
  if (4 * most > kMaxGathered) return;
  tree_.nearest(Vec3(0.5 * (DVec3(box_.low) + DVec3(box_.high))), {indices_.data(), most}, {squared_.data(), most});
  limit_ = above * squared_[most - 1];
  tree_.forEachLeaf(box_, limit_, [&](std::size_t begin, std::size_t end) {
    if (count_ >= kMaxGathered) return;
    const auto& [x, y, z] = tree_.coordinates_;
    squaredDistancesOf(kLeaf, &x[begin], &y[begin], &z[begin], DVec3(box_.low), DVec3(box_.high), squared_.data());
    for (std::size_t slot = begin; slot < end; ++slot) {
      gathered_[0][count_] = x[slot], gathered_[1][count_] = y[slot], gathered_[2][count_] = z[slot];
      indices_[count_] = tree_.order_[slot];
      count_ += squared_[slot - begin] <= limit_ ? 1 : 0;
    }
  });
}

std::size_t NearbySearch::nearest(const Vec3& p, std::span<std::uint32_t> indices, std::span<double> squaredDistances) {
  PALPATE_CHECK_EQ(indices.size(), squaredDistances.size());
  const std::size_t most = std::min(indices.size(), tree_.points_.size());
  if (most == 0) return 0;
  const DVec3 place(p);
  const auto isIn = [&] { return PointTree::squaredDistance(box_, place) == 0; };
  if (most_ != most || !isIn()) gather(place, most);
  std::size_t kept = 0;
  if (count_ < kMaxGathered && isIn()) {
    squaredDistancesOf(wholeLanes(count_), gathered_[0].data(), gathered_[1].data(), gathered_[2].data(), place, place,
                       squared_.data());
    for (std::size_t i = 0; i < count_; ++i) {
      kept_[kept] = squared_[i], keptIndices_[kept] = indices_[i];
      kept += squared_[i] <= limit_ ? 1 : 0;
    }
  }
  if (kept < most || kept > 4 * most) return tree_.nearest(p, indices, squaredDistances);
  const std::size_t padded = wholeLanes(kept);
  for (std::size_t i = kept; i < padded; ++i) kept_[i] = std::numeric_limits<double>::infinity();
  rankBy(kept, padded, kept_.data(), keptIndices_.data(), ranks_.data());
  for (std::size_t i = 0; i < kept; ++i) {
    const auto rank = static_cast<std::size_t>(ranks_[i]);
    if (rank < most) squaredDistances[rank] = kept_[i], indices[rank] = static_cast<std::uint32_t>(keptIndices_[i]);
  }
  return most;
}

}  // namespace palpate
