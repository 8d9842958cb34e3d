// A sheet with an open rim.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// A square sheet of 40 mm that faces up, with a point per square millimetre.
inline PointCloud openSheet() {
  PointCloud cloud;
  for (int y = -20; y <= 20; ++y)
    for (int x = -20; x <= 20; ++x) {
      cloud.positions.emplace_back(x, y, 0);
      cloud.normals.emplace_back(0, 0, 1);
    }
  return cloud;
}

}  // namespace palpate
