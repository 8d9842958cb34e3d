#include "engine/edit/sculpted_points.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/edit/placed_brush.hpp"

namespace palpate {

namespace {

std::uint32_t middleColor(std::uint32_t a, std::uint32_t b) {
  if (a == b) return a;
  auto middle = unpackedColor(a == 0 ? shared::kUnpainted : a);
  const auto other = unpackedColor(b == 0 ? shared::kUnpainted : b);
  for (std::size_t k = 0; k < middle.size(); ++k) middle[k] = static_cast<std::uint8_t>((middle[k] + other[k] + 1) / 2);
  return packedColor(middle);
}

Vec3 middleNormal(const Vec3& a, const Vec3& b) {
  constexpr float kOpposite = 1e-3f;
  const Vec3 sum = a + b;
  const float length = glm::length(sum);
  return length > kOpposite ? sum / length : a;
}

}  // namespace

SculptedPoints::SculptedPoints(const PointCloud& cloud)
    : positions(cloud.positions),
      normals(cloud.normals),
      colors(cloud.size()),
      parents(cloud.size()),
      there(cloud.size(), 1),
      unsettled(cloud.size(), 0),
      rests(cloud.positions),
      fromFile(static_cast<std::uint32_t>(cloud.size())) {
  PALPATE_CHECK_EQ(normals.size(), positions.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) colors[i] = palpate::packedColor(cloud, i);
  std::iota(parents.begin(), parents.end(), 0);
}

PointState SculptedPoints::state(std::uint32_t point) const {
  return {.position = positions[point],
          .id = there[point] ? point : point | PointState::kGone,
          .normal = normals[point],
          .color = colors[point],
          .parent = parents[point]};
}

void SculptedPoints::set(const PointState& state) {
  const std::uint32_t point = state.number();
  while (size() <= point) {
    positions.emplace_back(0);
    normals.emplace_back(0);
    colors.push_back(0);
    parents.push_back(state.parent);
    there.push_back(0);
    unsettled.push_back(0);
    rests.emplace_back(std::numeric_limits<float>::quiet_NaN());
    reaches.push_back(0);
  }
  positions[point] = state.position;
  normals[point] = state.normal;
  colors[point] = state.color;
  parents[point] = state.parent;
  there[point] = !state.gone();
  unsettled[point] = 0;
  if (std::isnan(rests[point].x)) rests[point] = state.position;
}

std::uint32_t SculptedPoints::insertBetween(std::uint32_t point, std::uint32_t other, std::uint32_t parent,
                                            const Vec3& position) {
  const auto number = static_cast<std::uint32_t>(size());
  set({.position = position,
       .id = number,
       .normal = middleNormal(normals[point], normals[other]),
       .color = middleColor(colors[point], colors[other]),
       .parent = parents[parent]});
  unsettled[number] = 1;
  rests[number] = 0.5f * (rests[point] + rests[other]);
  return number;
}

}  // namespace palpate
