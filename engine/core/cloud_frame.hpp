#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Where the points of a cloud are at one time. It may have fewer points than the cloud has ids: the others are not there.
struct CloudFrame {
  double time_s = 0;                ///< that it is true for
  std::vector<Vec3> positions;      ///< model units, relative to the cloud's origin
  std::vector<Vec3> normals;        ///< unit
  std::vector<Vec3> velocities;     ///< model units per second; empty where they are not known
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< empty where points keep theirs
  std::vector<std::uint32_t> ids;   ///< of the points, ascending; empty where each one's is its place here

  std::size_t size() const { return positions.size(); }
  std::uint32_t idOf(std::size_t i) const { return ids.empty() ? static_cast<std::uint32_t>(i) : ids[i]; }
};

}  // namespace palpate
