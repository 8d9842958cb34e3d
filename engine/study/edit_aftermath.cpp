#include "engine/study/edit_aftermath.hpp"

#include <algorithm>

#include "engine/cloud/eigen3.hpp"
#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr std::size_t kFewestOfAFit = 6;
constexpr double kWallFrom = 0.85, kWallTo = 1.02;  // brush radii from the path: the wall that the tool leaves
constexpr double kEdgeOn = 0.5;      // cosine of a normal and a direction up to which the normal shows no side
constexpr double kCrushed = 0.1;     // share of the original area below which a crushed piece shows no side
constexpr double kDetermined = 0.5;  // product of correlations below which the motion shows none

// Normal of the plane through `places`, of either sign; empty if there are too few, or if they do not span a plane.
std::optional<DVec3> planeThrough(std::span<const DVec3> places) {
  if (places.size() < kFewestOfAFit) return std::nullopt;
  DVec3 mean(0);
  for (const DVec3& place : places) mean += place / static_cast<double>(places.size());
  SymmetricMatrix3 spread;
  for (const DVec3& place : places) spread.addSquare(place - mean);
  const Eigen3 axes = eigenSymmetric(spread);
  if (axes.values[0] > 0.25 * axes.values[1]) return std::nullopt;
  return axes.vectors[0];
}

}  // namespace

NearestPoints nearestTo(const PointTree& tree, const DVec3& place) {
  NearestPoints near;
  near.count = tree.nearest(Vec3(place), near.points, near.squared);
  return near;
}

bool tellsItsSide(const PointCloud& cloud, const PointTree& tree, std::uint32_t point) {
  const DVec3 facing(cloud.normals[point]), place(cloud.positions[point]);
  const NearestPoints near = nearestTo(tree, place);
  std::vector<DVec3> offsets;
  for (std::size_t k = 0; k < near.count && offsets.size() < kOfAFit; ++k)
    if (glm::dot(DVec3(cloud.normals[near.points[k]]), facing) > 0)
      offsets.push_back(DVec3(cloud.positions[near.points[k]]) - place);
  const std::optional<DVec3> plane = planeThrough(offsets);
  return plane && std::abs(glm::dot(*plane, facing)) > kEdgeOn;
}

std::optional<DVec3> carriedNormal(const PointCloud& before, const PointTree& tree, std::span<const PointState> after,
                                   std::uint32_t point) {
  const DVec3 facing(before.normals[point]), place(before.positions[point]), moved(after[point].position);
  const Frame3 frame = frameAround(facing);
  const NearestPoints near = nearestTo(tree, place);
  std::vector<DVec2> were;
  std::vector<DVec3> are;
  DVec2 wereMean(0);
  DVec3 areMean(0);
  for (std::size_t k = 0; k < near.count && were.size() < kOfAFit; ++k) {
    const std::uint32_t other = near.points[k];
    if (after[other].gone() || glm::dot(DVec3(before.normals[other]), facing) <= 0) continue;
    const DVec3 was = DVec3(before.positions[other]) - place;
    wereMean += were.emplace_back(glm::dot(was, frame.u), glm::dot(was, frame.v));
    areMean += are.emplace_back(DVec3(after[other].position) - moved);
  }
  const auto count = static_cast<double>(were.size());
  double uu = 0, uv = 0, vv = 0;
  DVec3 alongU(0), alongV(0);
  SymmetricMatrix3 spread;
  for (std::size_t k = 0; k < were.size(); ++k) {
    const DVec2 was = were[k] - wereMean / count;
    const DVec3 is = are[k] - areMean / count;
    uu += was.x * was.x, uv += was.x * was.y, vv += was.y * was.y;
    alongU += was.x * is, alongV += was.y * is;
    spread.addSquare(is);
  }
  const double det = uu * vv - uv * uv;
  if (det <= 0) return std::nullopt;
  const DVec3 across = glm::cross(vv * alongU - uv * alongV, uu * alongV - uv * alongU) / (det * det);
  const double area = glm::length(across);
  if (area < kCrushed) return std::nullopt;
  // Of the two canonical correlations: how well the positions before determine those along the surface after.
  const Eigen3 axes = eigenSymmetric(spread);
  const double correlated = glm::length(glm::cross(alongU, alongV)) / std::sqrt(det * axes.values[1] * axes.values[2]);
  if (correlated < kDetermined) return std::nullopt;
  return across / area;
}

EditAftermath::EditAftermath(const PointCloud& before, const PointTree& tree, std::span<const PointState> after,
                             const BrushPath& way)
    : before_(before),
      treeBefore_(tree),
      after_(after),
      way_(way),
      sides_(before.size()),
      tells_(before.size()),
      facings_(after.size()) {
  for (std::uint32_t i = 0; i < after.size(); ++i) {
    if (after[i].gone()) continue;
    facings_[i] = facingOf(i);
    there_.push_back(i);
    positions_.push_back(after[i].position);
  }
  tree_.emplace(positions_);
}

std::uint32_t EditAftermath::ancestorOf(std::uint32_t i) const {
  while (isNew(i)) {
    PALPATE_CHECK_LT(after_[i].parent, i);
    i = after_[i].parent;
  }
  return i;
}

bool EditAftermath::wereTwoSides(std::uint32_t i, std::uint32_t k, double most) const {
  const std::uint32_t one = ancestorOf(i), other = ancestorOf(k);
  constexpr double kOpposite = -0.3;  // cosine
  const DVec3 facing = normalBefore(one);
  return glm::dot(facing, normalBefore(other)) < kOpposite &&
         std::abs(glm::dot(placeBefore(other) - placeBefore(one), facing)) < most;
}

double EditAftermath::nearestOfSheet(std::uint32_t i, double most) const {
  std::vector<std::uint32_t> found;
  tree_->near(position(i), most, found);
  double nearest = most;
  for (const std::uint32_t k : found)
    if (there_[k] != i && glm::dot(normal(there_[k]), normal(i)) > 0)
      nearest = std::min(nearest, glm::distance(position(there_[k]), position(i)));
  return nearest;
}

std::optional<DVec3> EditAftermath::fit(std::uint32_t i) const {
  const NearestPoints near = nearestTo(*tree_, position(i));
  std::vector<DVec3> offsets;
  for (std::size_t k = 0; k < near.count && offsets.size() < kOfAFit; ++k) {
    const std::uint32_t other = there_[near.points[k]];
    if (glm::dot(facing(other), facing(i)) > 0) offsets.push_back(position(other) - position(i));
  }
  return planeThrough(offsets);
}

// Brushes that leave no wall bend a sheet and its normals. A point that is neither on a wall nor bent faces like its
// ancestor; like the nearest point if it is too far from its ancestor.
DVec3 EditAftermath::facingOf(std::uint32_t i) {
  const std::uint32_t ancestor = ancestorOf(i);
  if (isNew(i) || moved(i)) {
    if (const std::optional<DVec3> wall = wallFacing(i, ancestor)) return *wall;
    if (!tellsItsSide(ancestor)) return normal(i);
  }
  if (!way_.carves && !way_.pushes && moved(ancestor))
    return carriedNormal(before_, treeBefore_, after_, ancestor).value_or(normal(i));
  if (!isNew(i) || glm::distance(placeBefore(ancestor), position(i)) < kKin * way_.support)
    return normalBefore(ancestor);
  return normalBefore(nearestTo(treeBefore_, position(i)).points[0]);
}

// On the ball's wall, towards its centre or away from it, by the side that the ancestor showed the arriving ball: a
// ball that enters sideways lines its tunnel with the sheet in front of it, and lifts the sheet above it from behind.
// Sheets met edge on may face either way. Empty for a point off the wall.
std::optional<DVec3> EditAftermath::wallFacing(std::uint32_t i, std::uint32_t ancestor) {
  if ((!way_.carves && !way_.pushes) || way_.centers.empty()) return std::nullopt;
  const DVec3 outward = nearestCenter(position(i)) - position(i);
  const double distance = glm::length(outward);
  if (distance <= kWallFrom * way_.radius || distance >= kWallTo * way_.radius) return std::nullopt;
  const double side = way_.carves ? 1 : tellsItsSide(ancestor) ? sideOf(ancestor) : 0;
  return std::abs(side) > kEdgeOn ? std::copysign(1 / distance, side) * outward : normal(i);
}

bool EditAftermath::tellsItsSide(std::uint32_t point) {
  if (!tells_[point]) tells_[point] = palpate::tellsItsSide(before_, treeBefore_, point);
  return *tells_[point];
}

// How much a point faced the ball at the first contact, or at the smallest distance: from -1 (facing away) to 1.
double EditAftermath::sideOf(std::uint32_t point) {
  if (sides_[point]) return *sides_[point];
  const DVec3 place = placeBefore(point);
  const auto touches = [&](const DVec3& c) { return glm::distance(c, place) < kWallTo * way_.radius; };
  const auto first = std::ranges::find_if(way_.centers, touches);
  const DVec3 offset = (first != way_.centers.end() ? *first : nearestCenter(place)) - place;
  return sides_[point].emplace(glm::dot(offset, normalBefore(point)) / std::max(way_.radius, glm::length(offset)));
}

DVec3 EditAftermath::nearestCenter(const DVec3& place) const {
  return *std::ranges::min_element(way_.centers, {}, [&](const DVec3& c) { return glm::distance(c, place); });
}

}  // namespace palpate
