// A flat cloud, or a plate, for tests of the proxy.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

// Grids of 81 x 81 points with a spacing of 0.5: on z = 0 facing up and, for a plate, on z = -thickness facing down.
inline PointCloud sheet(double thickness = 0) {
  PointCloud cloud;
  for (int i = -40; i <= 40; ++i)
    for (int j = -40; j <= 40; ++j) {
      cloud.positions.emplace_back(0.5 * i, 0.5 * j, 0);
      cloud.normals.emplace_back(0, 0, 1);
      if (thickness <= 0) continue;
      cloud.positions.emplace_back(0.5 * i + 0.25, 0.5 * j, -thickness);
      cloud.normals.emplace_back(0, 0, -1);
    }
  return cloud;
}
inline constexpr double kSheetRadius = 2;

}  // namespace palpate
