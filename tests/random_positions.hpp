#pragma once

#include <random>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Uniformly random positions in a cube of edge 2 `extent`.
inline std::vector<Vec3> randomPositions(std::size_t count, const Vec3& center, float extent) {
  std::mt19937 random(static_cast<std::uint32_t>(count));
  std::uniform_real_distribution<float> uniform(-extent, extent);
  std::vector<Vec3> positions(count);
  for (auto& position : positions) position = center + Vec3{uniform(random), uniform(random), uniform(random)};
  return positions;
}

}  // namespace palpate
