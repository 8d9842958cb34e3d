#include "engine/cloud/placed_points.hpp"

#include <bit>

#include "engine/core/check.hpp"

namespace palpate {

std::size_t takeBack(PointCloud& cloud, std::span<const Vec4> positions, std::span<const Vec4> normals) {
  PALPATE_CHECK_EQ(positions.size(), cloud.size());
  PALPATE_CHECK_EQ(normals.size(), cloud.size());
  std::size_t moved = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto number = std::bit_cast<std::uint32_t>(positions[i].w);
    PALPATE_CHECK_LT(std::size_t{number}, cloud.size());
    const Vec3 position(positions[i]);
    if (position == cloud.positions[number]) continue;
    ++moved;
    cloud.positions[number] = position;
    cloud.normals[number] = Vec3(normals[i]);
  }
  return moved;
}

}  // namespace palpate
