#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Where the points of a cloud are at one time, in the order of their ids. A frame may have fewer points than the cloud
/// has slots: the others are empty.
struct CloudFrame {
  double time_s = 0;             ///< that it is true for
  std::vector<Vec3> positions;   ///< model units, relative to the cloud's origin
  std::vector<Vec3> normals;     ///< unit
  std::vector<Vec3> velocities;  ///< model units per second; empty where they are not known
  std::vector<std::array<std::uint8_t, 4>> colors;  ///< RGBA; empty where points keep theirs
};

}  // namespace palpate
