#pragma once

#include <memory>
#include <unordered_map>

#include "engine/cloud/neighbour_search.hpp"
#include "engine/spatial/hash_grid.hpp"

namespace palpate {

/// The CPU baseline of the thesis (section 4.1): a multimap from bucket number to point, one insertion per point.
class MultimapHash {
 public:
  explicit MultimapHash(const HashGrid& grid) : grid_(grid) {}

  void build(std::span<const Vec3> positions);
  /// Erases and inserts each point.
  void move(std::span<const PointMove> moves);
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const;
  std::string_view name() const { return "multimap"; }
  /// With the rounding of glibc's allocator.
  std::size_t bytes() const;

 private:
  struct Point {
    Vec3 position;
    std::uint32_t number;
  };
  using Map = std::unordered_multimap<std::uint32_t, Point>;

  std::uint32_t bucketAt(const Vec3& position) const { return bucketOf(grid_, cellOf(grid_, position)); }

  HashGrid grid_;
  std::span<const Vec3> positions_;
  Map map_;
};

/// A peer that follows edits: nanoflann's dynamic k-d tree, a row of static trees of doubling sizes (Bentley and Saxe
/// 1980), of which an insertion merges the smallest. A removed point is only marked, so that memory and the cost of a
/// query grow with the moves since the last build.
class DynamicTree {
 public:
  DynamicTree();
  ~DynamicTree();
  DynamicTree(const DynamicTree&) = delete;
  DynamicTree& operator=(const DynamicTree&) = delete;

  void build(std::span<const Vec3> positions);
  /// Removes each point and inserts it where it is now, all of them together.
  void move(std::span<const PointMove> moves);
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const;
  std::string_view name() const { return "dynamic k-d tree"; }
  std::size_t bytes() const;

 private:
  struct Index;
  std::span<const Vec3> positions_;
  std::unique_ptr<Index> index_;
};

}  // namespace palpate
