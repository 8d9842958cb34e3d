// Integer coordinates of a cloud, as stored in LAS.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct LasGrid {
  CoordinateGrid grid;
  bool exact = true;  ///< every point is exactly on the grid, bit by bit
};

/// The grid of the original file; if points are off it and its step is not below a quarter of their spacing, refined by
/// a power of ten, so that points on it keep their values. Else the coarsest decimal grid, with steps from 1 to 1e-9,
/// that contains the points; else the finest power of two for which 32 bits suffice. The integers of all points fit
/// into 32 bits.
LasGrid lasGridFor(const PointCloud& cloud);

}  // namespace palpate
