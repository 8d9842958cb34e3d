// Coordinates as in the file, where it has more digits than single precision.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Whether PointCloud::fileCoordinates() are more precise than single precision.
inline bool isExact(const PointCloud& cloud) { return !cloud.exactPositions.empty() || cloud.storedAs.grid; }

/// The box around these coordinates. All zero for an empty cloud.
Bounds fileBoundsOf(const PointCloud& cloud);

}  // namespace palpate
