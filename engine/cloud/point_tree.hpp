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

/// A k-d tree. Keeps a view of the points, which must outlive it unchanged. Queries are safe from any thread.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3> points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  /// The nearest points to `p`, nearest first, up to the size of `indices` (including the point itself if `p` is in the
  /// set). Returns the number found. `squaredDistances` has the same size.
  std::size_t nearest(const Vec3& p, std::span<std::uint32_t> indices, std::span<double> squaredDistances) const;
  /// Appends every point strictly nearer than `radius` to `center`, in any order.
  void within(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const;

  /// Memory in addition to the points.
  std::size_t bytes() const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace palpate
