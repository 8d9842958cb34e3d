#include "engine/matter/winding_number.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {

namespace {

constexpr std::uint32_t kPointsOfLeaf = 8;
// In radii of a node: distance from which its points are approximated by one dipole.
constexpr double kFar = 3;

}  // namespace

WindingNumber::WindingNumber(std::vector<OrientedArea> points) : points_(std::move(points)) {
  if (!points_.empty()) build(0, static_cast<std::uint32_t>(points_.size()));
}

void WindingNumber::build(std::uint32_t first, std::uint32_t count) {
  const std::size_t number = nodes_.size();
  Node& node = nodes_.emplace_back(Node{.first = first, .count = count, .isLeaf = count <= kPointsOfLeaf});
  const std::span<OrientedArea> points = std::span(points_).subspan(first, count);
  DVec3 low(points[0].place), high = low, sum(0);
  double area = 0;
  for (const OrientedArea& point : points) {
    low = glm::min(low, DVec3(point.place));
    high = glm::max(high, DVec3(point.place));
    sum += static_cast<double>(point.area) * DVec3(point.place);
    area += static_cast<double>(point.area);
    node.dipole += static_cast<double>(point.area) * DVec3(point.normal);
  }
  node.middle = area > 0 ? sum / area : (low + high) / 2.0;
  for (const OrientedArea& point : points)
    node.radius = std::max(node.radius, glm::length(DVec3(point.place) - node.middle));
  if (!node.isLeaf) {
    const DVec3 sides = high - low;
    const int axis = sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    std::ranges::nth_element(points, points.begin() + half, {},
                             [&](const OrientedArea& point) { return point.place[axis]; });
    build(first, half);
    build(first + half, count - half);
  }
  nodes_[number].behind = static_cast<std::uint32_t>(nodes_.size());
}

double WindingNumber::at(const DVec3& place) const {
  double sum = 0;
  for (std::uint32_t n = 0; n < nodes_.size();) {
    const Node& node = nodes_[n];
    const DVec3 offset = node.middle - place;
    const double distance2 = glm::dot(offset, offset);
    if (distance2 > kFar * kFar * node.radius * node.radius && !node.isLeaf) {
      sum += glm::dot(node.dipole, offset) / (distance2 * std::sqrt(distance2));
      n = node.behind;
      continue;
    }
    if (node.isLeaf)
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
        const OrientedArea& point = points_[k];
        const DVec3 away = DVec3(point.place) - place;
        const auto area = static_cast<double>(point.area);
        const double nearest2 = std::max(glm::dot(away, away), area / std::numbers::pi);  // at least the disc's radius
        if (nearest2 > 0) sum += area * glm::dot(DVec3(point.normal), away) / (nearest2 * std::sqrt(nearest2));
      }
    ++n;  // for a leaf this is `behind`, as it has no descendants
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace palpate
