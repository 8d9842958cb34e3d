// Neighbours on the CPU, for loading and for comparisons. (The touch side has its own index, engine/spatial.)
#pragma once

#include <array>

#include "engine/cloud/neighbour_search.hpp"
#include "engine/core/bare_vector.hpp"

namespace palpate {

/// A balanced k-d tree (Bentley 1975) with the boxes of its nodes, rebuilt whenever points have moved. It keeps a view
/// of the points, which must outlive it. Queries are safe from any thread. Nothing depends on the number of threads.
class PointTree {
 public:
  /// Builds with `threads` (0: one per core).
  explicit PointTree(std::span<const Vec3> points = {}, unsigned threads = 1);
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  /// The nearest points to `p`, nearest first, of the same distance those of lower index, up to the size of `indices`
  /// (including the point itself if `p` is in the set). Returns the number found. `squaredDistances` has the same size.
  std::size_t nearest(const Vec3& p, std::span<std::uint32_t> indices, std::span<double> squaredDistances) const;

  /// All points, so that consecutive ones are near each other: queries in this order find their part of the tree in the
  /// cache.
  std::span<const std::uint32_t> order() const { return {order_.data(), points_.size()}; }

  void build(std::span<const Vec3> positions, unsigned threads = 1);
  void move(std::span<const PointMove> moves);
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const;
  std::string_view name() const { return "k-d tree"; }
  std::size_t bytes() const;

 private:
  friend class NearbySearch;
  struct Box {
    Vec3 low, high;
  };
  static constexpr std::size_t kLeaf = 16;  // maximum number of points
  struct Entry;
  class Builder;
  static double squaredDistance(const Box& box, const DVec3& p);
  static double squaredDistance(const Box& a, const Box& b);
  template <class Place, class Use>
  void forEachLeaf(const Place& place, const double& limit, Use&& use) const;

  std::span<const Vec3> points_;
  BareVector<std::uint32_t> order_;
  std::array<BareVector<float>, 3> coordinates_;  // in that order, and a leaf longer
  BareVector<Box> boxes_;                         // of node n; its children are 2 n and 2 n + 1, and the root is 1
  unsigned depth_ = 0;
};

/// PointTree::nearest() for many positions, with the same results. It takes a third of the time where consecutive ones
/// are close to each other and to points of the tree, as in its order(): the points around a leaf are gathered once for
/// all positions in it. For one thread; keeps its memory.
class NearbySearch {
 public:
  explicit NearbySearch(const PointTree& tree) : tree_(tree) {}
  std::size_t nearest(const Vec3& p, std::span<std::uint32_t> indices, std::span<double> squaredDistances);

 private:
  static constexpr std::size_t kLeaf = PointTree::kLeaf, kMaxGathered = 1024;
  template <class T>
  using Gathered = std::array<T, kMaxGathered + kLeaf>;

  void gather(const DVec3& p, std::size_t most);

  const PointTree& tree_;
  PointTree::Box box_{};                       // of the leaf
  std::size_t most_ = 0;                       // number of nearest points that were wanted
  double limit_ = 0;                           // squared distance from the box within which all points were gathered
  std::size_t count_ = 0;                      // of these; kMaxGathered: too many to be of use
  std::array<Gathered<float>, 3> gathered_{};  // their coordinates
  Gathered<std::uint32_t> indices_;
  Gathered<double> squared_, kept_, keptIndices_;  // distances from the present position; those within the limit
  Gathered<std::int64_t> ranks_;
};

}  // namespace palpate
