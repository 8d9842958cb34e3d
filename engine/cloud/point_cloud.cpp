#include "engine/cloud/point_cloud.hpp"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "engine/core/parallel_collect.hpp"

namespace palpate {

DVec3 CoordinateGrid::nearest(const DVec3& p) const { return glm::round((p - offset) / step); }

DVec3 PointCloud::fileCoordinates(std::size_t i) const {
  if (!exactPositions.empty() && Vec3(exactPositions[i] - origin) == positions[i]) return exactPositions[i];
  const DVec3 place = origin + DVec3(positions[i]);
  if (!storedAs.grid) return place;
  const DVec3 onGrid = storedAs.grid->at(storedAs.grid->nearest(place));
  return Vec3(onGrid - origin) == positions[i] ? onGrid : place;
}

double Bounds::longestSide() const {
  const DVec3 side = max - min;
  return std::max(side.x, std::max(side.y, side.z));
}

bool Bounds::contains(const DVec3& p) const {
  return glm::all(glm::lessThanEqual(min, p)) && glm::all(glm::lessThanEqual(p, max));
}

Bounds boundsOf(const PointCloud& cloud) {
  constexpr std::size_t kMany = std::size_t{1} << 20;  // points from which starting threads pays off
  if (cloud.empty()) return {};
  struct Corners {
    Vec3 low, high;
  };
  const Corners all = parallelReduce(
      cloud.size(), cloud.size() < kMany ? 1 : 0, Corners{cloud.positions.front(), cloud.positions.front()},
      [&](std::size_t begin, std::size_t end) {
        Corners box{cloud.positions[begin], cloud.positions[begin]};
        for (std::size_t i = begin; i < end; ++i) {
          box.low = glm::min(box.low, cloud.positions[i]);
          box.high = glm::max(box.high, cloud.positions[i]);
        }
        return box;
      },
      [](const Corners& a, const Corners& b) {
        return Corners{glm::min(a.low, b.low), glm::max(a.high, b.high)};
      });
  return {DVec3(all.low), DVec3(all.high)};
}

DVec3 originFor(const Bounds& box) {
  constexpr double kFarInSides = 16;
  const DVec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
  const double side = box.longestSide();
  if (std::max(farthest.x, std::max(farthest.y, farthest.z)) <= kFarInSides * side) return DVec3(0);
  if (side <= 0) return box.center();
  const double step = std::exp2(std::floor(std::log2(side)));
  return glm::round(box.center() / step) * step;
}

}  // namespace palpate
