#include "engine/edit/sculpted_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/core/large_array.hpp"
#include "engine/core/parallel.hpp"
#include "engine/edit/placed_brush.hpp"

#include "shaders/shared/resample.h"

namespace palpate {

namespace {

// Memory is reserved for this share of new points, or so many, so that an insertion copies no arrays before there are
// more; memory that is not used is not touched.
constexpr std::size_t kShareOfNew = 2, kFewestNew = 1 << 16;

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

SculptedPoints::SculptedPoints(const PointCloud& cloud) : fromFile(static_cast<std::uint32_t>(cloud.size())) {
  PALPATE_CHECK_EQ(cloud.normals.size(), cloud.size());
  const std::size_t count = cloud.size(), room = count + std::max(count / kShareOfNew, kFewestNew);
  const auto copyTo = [&](std::vector<Vec3>& to, const std::vector<Vec3>& from) {
    reserveLarge(to, room);
    to.assign(from.begin(), from.end());
  };
  // One task per array, since a std::vector is filled by one thread; for many points the total time is about that of
  // the longest task.
  const std::array<std::function<void()>, 7> arrays{
      [&] { copyTo(positions, cloud.positions); },
      [&] { copyTo(normals, cloud.normals); },
      [&] { copyTo(rests, cloud.positions); },
      [&] {
        reserveLarge(colors, room);
        for (std::size_t i = 0; i < count; ++i) colors.push_back(palpate::packedColor(cloud, i));
      },
      [&] {
        reserveLarge(parents, room);
        for (std::size_t i = 0; i < count; ++i) parents.push_back(static_cast<std::uint32_t>(i));
      },
      [&] {
        for (std::vector<std::uint8_t>* flags : {&there, &unsettled}) flags->reserve(room);
        there.assign(count, 1);
        unsettled.assign(count, 0);
        reaches.reserve(room - count);
      },
      [&] {
        reserveLarge(founds, room);
        founds.resize(count);
        reserveLarge(strokes, room);
        strokes.resize(count);
      },
  };
  constexpr std::size_t kMany = std::size_t{1} << 18;  // points from which starting threads pays off
  parallelBlocks(arrays.size(), 1, count < kMany ? 1 : 0, [&](std::size_t k, std::size_t) { arrays[k](); });
}

PointState SculptedPoints::state(std::uint32_t point) const {
  return {.position = positions[point],
          .gone = !there[point],
          .number = point,
          .normal = normals[point],
          .color = colors[point],
          .parent = parents[point]};
}

void SculptedPoints::set(const PointState& state) {
  const std::uint64_t point = state.number;
  while (size() <= point) {
    positions.emplace_back(0);
    normals.emplace_back(0);
    colors.push_back(0);
    parents.push_back(static_cast<std::uint32_t>(state.parent));
    there.push_back(0);
    unsettled.push_back(0);
    founds.emplace_back();
    strokes.push_back(0);
    rests.emplace_back(std::numeric_limits<float>::quiet_NaN());
    reaches.push_back(0);
  }
  positions[point] = state.position;
  normals[point] = state.normal;
  colors[point] = state.color;
  parents[point] = static_cast<std::uint32_t>(state.parent);
  there[point] = !state.gone;
  unsettled[point] = 0;
  strokes[point] = 0;
  if (std::isnan(rests[point].x)) rests[point] = state.position;
}

std::uint32_t SculptedPoints::insertBetween(std::uint32_t point, std::uint32_t other, std::uint32_t parent,
                                            const Vec3& position) {
  const auto number = static_cast<std::uint32_t>(size());
  set({.position = position,
       .number = number,
       .normal = middleNormal(normals[point], normals[other]),
       .color = middleColor(colors[point], colors[other]),
       .parent = parents[parent]});
  unsettled[number] = 1;
  rests[number] = 0.5f * (rests[point] + rests[other]);
  if (const std::uint32_t stroke = std::max(strokes[point], strokes[other]); stroke != 0) {
    const Found one = found(point, stroke), two = found(other, stroke);
    setFound(number, {{0.5f * (one.position + two.position), middleNormal(one.normal, two.normal),
                       shared::middleRoom(one.room, two.room)},
                      stroke});
  }
  return number;
}

}  // namespace palpate
