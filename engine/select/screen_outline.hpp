#pragma once

#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A closed outline in a picture: a rectangle, a polygon or a lasso. What it winds around is inside (nonzero rule), so
/// that a lasso that crosses itself has no holes.
class ScreenOutline {
 public:
  /// `corners`: pixels, finite, in order; the last one is joined to the first. Fewer than three enclose nothing.
  explicit ScreenOutline(std::span<const DVec2> corners);

  /// By the winding number (Sunday, Inclusion of a Point in a Polygon, 2001), of the edges in a row of the picture. A
  /// position on an edge may be inside or not, but is inside exactly one of two outlines that share that edge. From any
  /// thread.
  bool contains(const DVec2& place_px) const;

 private:
  struct Edge {
    DVec2 from, to;
  };
  // Clamped, so that none is beside the picture's rows.
  std::size_t rowOf(double y) const;

  DVec2 low_{0}, high_{-1};
  double rowHeight_ = 1;
  std::vector<std::vector<Edge>> rows_;  // from low_.y on: the edges that meet the row
};

}  // namespace palpate
