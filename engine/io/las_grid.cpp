#include "engine/io/las_grid.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "engine/cloud/spacing.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

namespace {

constexpr double kMin = std::numeric_limits<std::int32_t>::min();
constexpr double kMaxSteps = std::numeric_limits<std::int32_t>::max();

Bounds boxInFile(const PointCloud& cloud) {
  const DVec3 first = cloud.fileCoordinates(0);
  const auto boxOf = [&](std::size_t begin, std::size_t end) {
    Bounds box{first, first};
    for (std::size_t i = begin; i < end; ++i) {
      const DVec3 p = cloud.fileCoordinates(i);
      box = {glm::min(box.min, p), glm::max(box.max, p)};
    }
    return box;
  };
  const auto both = [](const Bounds& a, const Bounds& b) {
    return Bounds{glm::min(a.min, b.min), glm::max(a.max, b.max)};
  };
  return parallelReduce(cloud.size(), 0, Bounds{first, first}, boxOf, both);
}

double largest(const DVec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Whether the integers of all points fit into 32 bits.
bool fits(const CoordinateGrid& grid, const Bounds& box) {
  for (const DVec3& corner : {grid.nearest(box.min), grid.nearest(box.max)})
    for (int k = 0; k < 3; ++k)
      if (!(corner[k] >= kMin && corner[k] <= kMaxSteps)) return false;
  return true;
}

/// `beside`: allowed distance from the grid, relative to the coordinate.
bool allOn(const CoordinateGrid& grid, const PointCloud& cloud, double beside) {
  std::atomic<bool> all = true;
  parallelBlocks(cloud.size(), 1 << 16, 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && all; ++i) {
      const DVec3 p = cloud.fileCoordinates(i);
      const DVec3 on = grid.at(grid.nearest(p));
      for (int k = 0; k < 3; ++k)
        if (!(std::abs(on[k] - p[k]) <= beside * std::abs(p[k]))) all = false;
    }
  });
  return all;
}

/// For moved points: the same grid while its steps are below a quarter of the spacing, else steps of a tenth, a
/// hundredth and so on, as far as 32 bits allow.
CoordinateGrid refined(const CoordinateGrid& grid, const PointCloud& cloud, const Bounds& box) {
  constexpr double kMaxParts = 1e9;
  const double most = 0.25 * meanSpacing(cloud);
  CoordinateGrid finer = grid;
  for (int k = 0; k < 3; ++k)
    for (double parts = 10; most > 0 && std::abs(finer.step[k]) >= most && parts <= kMaxParts; parts *= 10) {
      CoordinateGrid next = finer;
      next.step[k] = grid.step[k] / parts;
      if (!fits(next, box)) break;
      finer = next;
    }
  return finer;
}

}  // namespace

LasGrid lasGridFor(const PointCloud& cloud) {
  constexpr double kRounding = 4e-16;  // of a decimal that is the sum of two
  const auto& known = cloud.storedAs.grid;
  if (cloud.empty()) return {known.value_or(CoordinateGrid{DVec3(1e-3), DVec3(0)})};
  const Bounds box = boxInFile(cloud);
  if (known && fits(*known, box)) {
    if (allOn(*known, cloud, 0)) return {*known};
    return {refined(*known, cloud, box), false};
  }
  const DVec3 middle = glm::round(box.center());
  for (double parts = 1; parts <= 1e9; parts *= 10) {
    CoordinateGrid decimal{DVec3(1 / parts), DVec3(0)};
    if (!fits(decimal, box)) decimal.offset = middle;
    if (fits(decimal, box) && allOn(decimal, cloud, kRounding)) return {decimal, allOn(decimal, cloud, 0)};
  }
  // Uses half the range, so that a whole cell fits at either end.
  const auto finest = [](double reach) {
    return std::exp2(std::ceil(std::log2(std::max(reach, 1e-30) / (kMaxSteps / 2))));
  };
  CoordinateGrid binary{DVec3(finest(std::max(largest(box.min), largest(box.max)))), DVec3(0)};
  if (allOn(binary, cloud, 0)) return {binary};
  binary.step = DVec3(finest(0.5 * box.longestSide()));
  binary.offset = glm::round(box.center() / binary.step) * binary.step;
  return {binary, allOn(binary, cloud, 0)};
}

}  // namespace palpate
