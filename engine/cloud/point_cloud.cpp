#include "engine/cloud/point_cloud.hpp"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

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
  if (cloud.empty()) return {};
  Vec3 low = cloud.positions.front();
  Vec3 high = low;
  for (const Vec3& p : cloud.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return {DVec3(low), DVec3(high)};
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
