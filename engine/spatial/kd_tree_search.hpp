#pragma once

#include <memory>

#include "engine/cloud/point_tree.hpp"
#include "engine/spatial/neighbour_search.hpp"

namespace palpate {

/// A k-d tree, rebuilt whenever points have moved.
class KdTreeSearch final : public NeighbourSearch {
 public:
  void build(std::span<const Vec3> positions) override;
  void move(std::span<const PointMove> moves) override;
  void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const override;
  std::string_view name() const override { return "k-d tree"; }
  std::size_t bytes() const override { return tree_ ? tree_->bytes() : 0; }

 private:
  std::span<const Vec3> positions_;
  std::unique_ptr<PointTree> tree_;
};

}  // namespace palpate
