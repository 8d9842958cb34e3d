#include "engine/cloud/file_coordinates.hpp"

#include <cmath>

#include <glm/common.hpp>

#include "engine/core/parallel_collect.hpp"

namespace palpate {

Bounds fileBoundsOf(const PointCloud& cloud) {
  if (cloud.empty() || !isExact(cloud)) {
    const Bounds box = boundsOf(cloud);
    return {box.min + cloud.origin, box.max + cloud.origin};
  }
  const DVec3 first = cloud.fileCoordinates(0);
  return parallelReduce(
      cloud.size(), 0, Bounds{first, first},
      [&](std::size_t begin, std::size_t end) {
        Bounds box{cloud.fileCoordinates(begin), cloud.fileCoordinates(begin)};
        for (std::size_t i = begin; i < end; ++i) {
          const DVec3 place = cloud.fileCoordinates(i);
          box = {glm::min(box.min, place), glm::max(box.max, place)};
        }
        return box;
      },
      [](const Bounds& a, const Bounds& b) {
        return Bounds{glm::min(a.min, b.min), glm::max(a.max, b.max)};
      });
}

namespace {

constexpr double kMaxWhole = 1e14;  // below it, whole numbers and their quotients by powers of ten are rounded once

/// The least power of ten by which both are whole numbers; 0: none.
double partsOf(double step, double offset) {
  constexpr double kRounding = 1e-15, kMaxParts = 1e12;
  const auto isWhole = [](double x) {
    return std::abs(x) < kMaxWhole && std::abs(x - std::round(x)) <= kRounding * std::abs(x);
  };
  for (double parts = 1; parts <= kMaxParts; parts *= 10)
    if (std::abs(step * parts) > 0.5 && isWhole(step * parts) && isWhole(offset * parts)) return parts;
  return 0;
}

}  // namespace

TextCoordinates::TextCoordinates(const PointCloud& cloud) : cloud_(cloud) {
  if (const auto& grid = cloud.storedAs.grid)
    for (int axis = 0; axis < 3; ++axis) parts_[axis] = partsOf(grid->step[axis], grid->offset[axis]);
}

DVec3 TextCoordinates::at(std::size_t i) const {
  DVec3 place = cloud_.fileCoordinates(i);
  if (parts_ == DVec3(0)) return place;
  const CoordinateGrid& grid = *cloud_.storedAs.grid;
  const DVec3 onGrid = grid.at(grid.nearest(place));
  for (int axis = 0; axis < 3; ++axis) {
    const double whole = std::round(place[axis] * parts_[axis]);
    if (parts_[axis] > 0 && place[axis] == onGrid[axis] && std::abs(whole) < kMaxWhole)
      place[axis] = whole / parts_[axis];
  }
  return place;
}

}  // namespace palpate
