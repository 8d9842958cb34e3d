#include "engine/motion/cloud_source.hpp"

#include <bit>
#include <cstdint>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

bool areFinite(const std::vector<Vec3>& values) {
  // Bitwise, so that compilers vectorise it: the exponent bits of NaN and infinity are all ones.
  constexpr std::uint32_t kExponent = 0x7f800000u;
  std::uint32_t found = 0;
  for (const Vec3& value : values)
    for (int k = 0; k < 3; ++k) found |= (std::bit_cast<std::uint32_t>(value[k]) & kExponent) == kExponent;
  return found == 0;
}

void requireAll(std::size_t values, std::string_view what, const CloudFrame& frame) {
  if (values != frame.size())
    throw Error("a frame for {} s has {} {} for {} points", frame.time_s, values, what, frame.size());
}

void requireWhole(const std::vector<Vec3>& values, std::string_view what, const CloudFrame& frame) {
  requireAll(values.size(), what, frame);
  if (areFinite(values)) return;
  std::size_t wrong = 0;
  while (isFinite(values[wrong])) ++wrong;
  throw Error("a frame for {} s: in its {}, the value of point {} is not finite", frame.time_s, what, wrong);
}

}  // namespace

void requireWhole(const CloudFrame& frame, std::size_t points) {
  if (frame.size() > points)
    throw Error("a frame for {} s has {} points; the maximum of its source is {}", frame.time_s, frame.size(), points);
  requireWhole(frame.positions, "positions", frame);
  requireWhole(frame.normals, "normals", frame);
  if (!frame.velocities.empty()) requireWhole(frame.velocities, "velocities", frame);
  if (!frame.turns.empty()) requireWhole(frame.turns, "rotations of normals", frame);
  if (!frame.colors.empty()) requireAll(frame.colors.size(), "colours", frame);
  if (frame.ids.empty()) return;
  requireAll(frame.ids.size(), "ids", frame);
  for (std::size_t i = 0; i < frame.size(); ++i)
    if (frame.ids[i] >= points || (i > 0 && frame.ids[i] <= frame.ids[i - 1]))
      throw Error("a frame for {} s: point {} has the id {}; ids ascend, and are less than {}", frame.time_s, i,
                  frame.ids[i], points);
}

std::size_t placeAt(const CloudFrame& frame, PointCloud& cloud) {
  std::size_t moved = frame.size();
  if (frame.ids.empty() && frame.size() == cloud.size()) {
    moved = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) moved += frame.positions[i] != cloud.positions[i];
  } else {
    cloud = {.origin = cloud.origin,
             .positions = {},
             .normals = {},
             .colors = {},
             .extra = {},
             .exactPositions = {},
             .storedAs = cloud.storedAs};
  }
  cloud.positions = frame.positions;
  cloud.normals = frame.normals;
  if (frame.colors.empty()) return moved;
  cloud.colors.resize(frame.size());
  for (std::size_t i = 0; i < frame.size(); ++i)
    cloud.colors[i] = {frame.colors[i][0], frame.colors[i][1], frame.colors[i][2], 255};
  return moved;
}

}  // namespace palpate
