#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "engine/cloud/point_tree.hpp"
#include "engine/core/bare_vector.hpp"

namespace palpate {

/// Finds points of the same side of a surface. Queries are safe from any thread.
class FacingTree {
 public:
  FacingTree(BareVector<Vec3> positions, BareVector<Vec3> normals)
      : positions_(std::move(positions)), normals_(std::move(normals)), tree_(positions_, 0) {}

  /// Calls use(index, squared distance) for those of the nearest points that face as `facing` does, nearest first,
  /// until it returns false.
  template <class Use>
  void visit(const Vec3& at, const Vec3& facing, const Use& use) const {
    std::array<std::uint32_t, 16> found;
    std::array<double, 16> squared;
    const std::size_t count = tree_.nearest(at, found, squared);
    for (std::size_t i = 0; i < count; ++i)
      if (glm::dot(normals_[found[i]], facing) > 0 && !use(found[i], squared[i])) return;
  }
  /// So that consecutive queries find their part of the tree in the cache.
  std::span<const std::uint32_t> order() const { return tree_.order(); }
  const Vec3& position(std::uint32_t index) const { return positions_[index]; }
  const Vec3& normal(std::uint32_t index) const { return normals_[index]; }

 private:
  BareVector<Vec3> positions_, normals_;
  PointTree tree_;
};

}  // namespace palpate
