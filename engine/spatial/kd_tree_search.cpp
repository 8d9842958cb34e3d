#include "engine/spatial/kd_tree_search.hpp"

namespace palpate {

void KdTreeSearch::build(std::span<const Vec3> positions) {
  positions_ = positions;
  tree_.reset();  // first, so that only one exists at a time
  tree_ = std::make_unique<PointTree>(positions);
}

void KdTreeSearch::move(std::span<const PointMove> moves) {
  if (!moves.empty()) build(positions_);
}

void KdTreeSearch::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  if (tree_) tree_->within(center, radius, found);
}

}  // namespace palpate
