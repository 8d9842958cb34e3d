// The points around a group of positions, gathered once for all of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

/// The neighbours of positions whose balls touch the same cells: one pass over these cells, then a pass over
/// consecutive memory for each position. Keeps its memory between gathers. Used by one thread.
class GatheredPoints {
 public:
  /// Positions, and the radius of the balls about them.
  struct Balls {
    DVec3 low, high;  ///< bounds of the positions, relative to the cloud's origin, model units
    double radius;    ///< model units
    CellBox box;      ///< cells of each of the balls: cellsAround()
  };
  /// Gathers the points around all of these balls. A box of more than SortedGrid::kFewCells cells requires a single
  /// position.
  void gather(const SortedGrid& grid, const Balls& balls);
  /// Numbers of the gathered points.
  std::span<const std::uint32_t> numbers() const { return {numbers_.data(), count_}; }

  /// The points nearer than `radius` to a position, which is one of those gathered for, in the order in which
  /// SortedGrid::forEachNear() visits them; until the next call.
  struct Near {
    std::size_t count;
    const std::uint32_t* index;  ///< in numbers()
    const double *x, *y, *z;     ///< offset from the position
  };
  Near near(const DVec3& place, double radius) { return near(place, radius, kNone); }
  /// But for the point with the number `without`.
  Near near(const DVec3& place, double radius, std::uint32_t without);

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  void add(const SortedGrid::Placed& point, bool keep);

  std::size_t count_ = 0;
  std::vector<float> x_, y_, z_;
  std::vector<std::uint32_t> numbers_;
  // Of the last near(): by gathered point, then by near point.
  std::vector<double> squared_, offsetX_, offsetY_, offsetZ_;
  std::vector<std::uint32_t> near_;
};

}  // namespace palpate
