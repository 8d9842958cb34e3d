// Coordinates as the file has them, where it has more digits than single precision holds.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Whether PointCloud::fileCoordinates() are more than single precision holds.
inline bool isExact(const PointCloud& cloud) { return !cloud.exactPositions.empty() || cloud.storedAs.grid; }

/// The box around them. All zero for an empty cloud.
Bounds fileBoundsOf(const PointCloud& cloud);

}  // namespace palpate
