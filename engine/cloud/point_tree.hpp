// Neighbours on the CPU, for loading and for comparisons. (The touch side has its own index, engine/spatial.)
#pragma once

#include <memory>

#include "engine/cloud/neighbour_search.hpp"

namespace palpate {

/// A k-d tree, rebuilt whenever points have moved. It keeps a view of the points, which must outlive it. Queries are
/// safe from any thread.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3> points = {});
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  /// The nearest points to `p`, nearest first, up to the size of `indices` (including the point itself if `p` is in the
  /// set). Returns the number found. `squaredDistances` has the same size.
  std::size_t nearest(const Vec3& p, std::span<std::uint32_t> indices, std::span<double> squaredDistances) const;

  /// All points, so that consecutive ones are near each other: queries in this order find their part of the tree in the
  /// cache.
  std::span<const std::uint32_t> order() const;

  void build(std::span<const Vec3> positions);
  void move(std::span<const PointMove> moves);
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const;
  std::string_view name() const { return "k-d tree"; }
  std::size_t bytes() const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace palpate
