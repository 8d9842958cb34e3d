#include "apps/cli/model_lines.hpp"

#include <algorithm>
#include <cmath>

#include "engine/cloud/point_tree.hpp"
#include "haptics/session/framing.hpp"

namespace palpate {

namespace {

constexpr double kShortest = 0.02, kLongest = 0.06;  // of the longest side of the shown part
constexpr std::array<std::uint8_t, 3> kContainerColor{150, 160, 175};
constexpr double kCameraOpacity = 0.9;

/// Median distance of a camera to the nearest other one.
double usualGap(std::span<const CameraFrustum> cameras) {
  std::vector<Vec3> places;
  for (const CameraFrustum& camera : cameras) places.emplace_back(camera.centre - cameras.front().centre);
  const PointTree tree(places);
  std::vector<double> gaps;
  std::array<std::uint32_t, 2> nearest{};
  std::array<double, 2> squaredDistances{};
  for (const Vec3& place : places)
    if (tree.nearest(place, nearest, squaredDistances) == 2) gaps.push_back(std::sqrt(squaredDistances[1]));
  if (gaps.empty()) return 0;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::ranges::nth_element(gaps, middle);
  return *middle;
}

// The drawn box contains all discs of the points in the container.
Bounds drawnContainer(const Model& model) {
  const double disc = discRadiusOf(model);
  return {model.container()->min - disc, model.container()->max + disc};
}

}  // namespace

double frustumLength(const Model& model) {
  const double side = model.shownBounds().longestSide() > 0 ? model.shownBounds().longestSide() : 1;
  if (model.cameras.size() < 2) return kLongest * side;
  return std::clamp(0.5 * usualGap(model.cameras), kShortest * side, kLongest * side);
}

void addFrustum(std::vector<SpaceLine>& lines, const CameraFrustum& frustum, const DVec3& origin, double length,
                const std::array<std::uint8_t, 3>& color) {
  const DVec3 centre = frustum.centre - origin;
  const auto add = [&](const DVec3& from, const DVec3& to) {
    lines.push_back({.from = from, .to = to, .color = color, .opacity = kCameraOpacity});
  };
  std::array<DVec3, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) corners[k] = centre + length * frustum.corners[k];
  for (std::size_t k = 0; k < 4; ++k) {
    add(centre, corners[k]);
    add(corners[k], corners[(k + 1) % 4]);
  }
  constexpr double kRoof = 0.25;  // share of the picture's height
  const DVec3 ridge = 0.5 * (corners[0] + corners[1]) + kRoof * (corners[0] - corners[3]);
  add(corners[0], ridge);
  add(ridge, corners[1]);
}

PointCloud placesWithLines(const Model& model, bool cameras) {
  constexpr double kFarOff = 10;  // longest sides from the middle
  const Bounds box = model.container() ? drawnContainer(model) : model.shownBounds();
  PointCloud places;
  places.origin = model.cloud.origin;
  for (unsigned corner = 0; corner < 8; ++corner)
    places.positions.emplace_back((corner & 1 ? box.max : box.min).x, (corner & 2 ? box.max : box.min).y,
                                  (corner & 4 ? box.max : box.min).z);
  if (!cameras) return places;
  for (const CameraFrustum& camera : model.cameras) {
    const DVec3 place = camera.centre - model.cloud.origin;
    if (glm::distance(place, box.center()) <= kFarOff * box.longestSide()) places.positions.emplace_back(place);
  }
  return places;
}

void addContainer(std::vector<SpaceLine>& lines, const Model& model) {
  if (!model.container()) return;
  const auto corner = [&, box = drawnContainer(model)](unsigned number) {
    const auto& [min, max] = box;
    return DVec3(number & 1 ? max.x : min.x, number & 2 ? max.y : min.y, number & 4 ? max.z : min.z);
  };
  for (unsigned from = 0; from < 8; ++from)
    for (const unsigned axis : {1u, 2u, 4u})
      if ((from & axis) == 0)
        lines.push_back({.from = corner(from), .to = corner(from | axis), .color = kContainerColor});
}

std::vector<SpaceLine> modelLines(const Model& model, bool cameras) {
  std::vector<SpaceLine> lines;
  addContainer(lines, model);
  if (cameras && !model.cameras.empty()) {
    const double length = frustumLength(model);
    for (const CameraFrustum& camera : model.cameras) addFrustum(lines, camera, model.cloud.origin, length);
  }
  return lines;
}

}  // namespace palpate
