#include "engine/motion/cloud_source.hpp"

#include <bit>
#include <cstdint>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

bool areFinite(const std::vector<Vec3>& values) {
  // In words, which a compiler does many at a time: the exponent of what is no number, or infinite, is all ones.
  constexpr std::uint32_t kExponent = 0x7f800000u;
  std::uint32_t found = 0;
  for (const Vec3& value : values)
    for (int k = 0; k < 3; ++k) found |= (std::bit_cast<std::uint32_t>(value[k]) & kExponent) == kExponent;
  return found == 0;
}

void requireWhole(const std::vector<Vec3>& values, std::string_view what, const CloudFrame& frame, std::size_t points) {
  if (values.size() != points)
    throw Error("a frame for {} s has {} {}, and the source has {} points", frame.time_s, values.size(), what, points);
  if (areFinite(values)) return;
  std::size_t wrong = 0;
  while (isFinite(values[wrong])) ++wrong;
  throw Error("a frame for {} s: of the {}, that of point {} is no number", frame.time_s, what, wrong);
}

}  // namespace

void requireWhole(const CloudFrame& frame, std::size_t points) {
  requireWhole(frame.positions, "positions", frame, points);
  requireWhole(frame.normals, "normals", frame, points);
  if (!frame.velocities.empty()) requireWhole(frame.velocities, "velocities", frame, points);
}

std::size_t placeAt(const CloudFrame& frame, PointCloud& cloud) {
  PALPATE_CHECK_EQ(frame.positions.size(), cloud.size());
  std::size_t moved = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) moved += frame.positions[i] != cloud.positions[i];
  cloud.positions = frame.positions;
  cloud.normals = frame.normals;
  return moved;
}

}  // namespace palpate
