// Neighbours among a fixed set of points, on the CPU, for loading and for comparisons. (The touch side has its own
// index, engine/spatial.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A k-d tree. Keeps a view of the points, which must outlive it and stay as they are. Queries are safe from any
/// thread.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3> points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  /// The nearest points to `p`, nearest first, as many as `indices` has room for (one of them is the point itself when
  /// `p` is in the set). Returns how many were found. `squaredDistances` has the same room.
  std::size_t nearest(const Vec3& p, std::span<std::uint32_t> indices, std::span<double> squaredDistances) const;
  /// Appends every point strictly nearer than `radius` to `center`, in any order.
  void within(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const;

  /// Memory held besides the points.
  std::size_t bytes() const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace palpate
