// The target spacings of the points of a cloud as loaded, which edits maintain.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/spatial/gathered_points.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

/// Measures spacings of points from those around a group of them. Used by one thread.
class SpacingMeasure {
 public:
  /// Gathers the points of the grid around these positions; `normals` are of all points by number.
  void gather(const SortedGrid& grid, const GatheredPoints::Balls& balls, std::span<const Vec3> normals);
  /// Spacing around one of these positions, by the points of its sheet within `radius`; model units.
  double at(const DVec3& place, const DVec3& normal, double radius);

 private:
  GatheredPoints points_;
  NearPoints near_;
  std::vector<double> normalX_, normalY_, normalZ_;  // of the gathered points
  std::vector<double> nearX_, nearY_, nearZ_;        // of the near ones
  std::vector<double> weight_, distance_;            // of the near ones
  std::vector<std::uint32_t> sector_;
};

/// Returns the target spacing of each point of a cloud: where `known` is 0 as measured from the points of its sheet
/// within `radius`; model units. `grid` is the index of all points; its threads share the work.
std::vector<float> measuredSpacings(SortedGrid& grid, std::span<const Vec3> positions, std::span<const Vec3> normals,
                                    double radius, std::vector<float> known);

}  // namespace palpate
