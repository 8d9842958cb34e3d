#pragma once

#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Where all points of a cloud are at one time, in the order of their ids.
struct CloudFrame {
  double time_s = 0;             ///< that it is true for
  std::vector<Vec3> positions;   ///< model units, relative to the cloud's origin
  std::vector<Vec3> normals;     ///< unit
  std::vector<Vec3> velocities;  ///< model units per second; empty where they are not known
};

}  // namespace palpate
