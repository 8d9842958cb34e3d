#include "engine/select/screen_outline.hpp"

#include <algorithm>

namespace palpate {

ScreenOutline::ScreenOutline(std::span<const DVec2> corners) {
  constexpr double kMaxRows = 4096;
  if (corners.size() < 3) return;
  low_ = high_ = corners.front();
  for (const DVec2& corner : corners) {
    low_ = glm::min(low_, corner);
    high_ = glm::max(high_, corner);
  }
  rowHeight_ = std::max(1.0, (high_.y - low_.y) / kMaxRows);
  rows_.resize(static_cast<std::size_t>((high_.y - low_.y) / rowHeight_) + 1);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Edge edge{corners[k], corners[(k + 1) % corners.size()]};
    if (edge.from.y == edge.to.y) continue;
    const auto [first, last] = std::minmax({rowOf(edge.from.y), rowOf(edge.to.y)});
    for (std::size_t row = first; row <= last; ++row) rows_[row].push_back(edge);
  }
}

std::size_t ScreenOutline::rowOf(double y) const {
  return std::min(static_cast<std::size_t>(std::max(0.0, (y - low_.y) / rowHeight_)), rows_.size() - 1);
}

bool ScreenOutline::contains(const DVec2& place_px) const {
  if (!(place_px.x >= low_.x && place_px.y >= low_.y && place_px.x <= high_.x && place_px.y <= high_.y)) return false;
  int winding = 0;
  for (const Edge& edge : rows_[rowOf(place_px.y)]) {
    const DVec2 along = edge.to - edge.from, at = place_px - edge.from;
    const double side = along.x * at.y - along.y * at.x;
    if (edge.from.y <= place_px.y && edge.to.y > place_px.y)
      winding += side > 0;
    else if (edge.from.y > place_px.y && edge.to.y <= place_px.y)
      winding -= side < 0;
  }
  return winding != 0;
}

}  // namespace palpate
