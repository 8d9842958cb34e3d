// Whole numbers for the coordinates of a cloud, as LAS keeps them.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct LasGrid {
  CoordinateGrid grid;
  bool exact = true;  ///< every point is at a place of it, bit by bit
};

/// The grid that the cloud came with, finer by a power of two where points are beside it by now: those that are on it
/// stay what they are. Else the coarsest decimal one, of steps from 1 to 1e-9, whose places the points are; else the
/// finest of a power of two that 32 bits reach over. Its whole numbers fit 32 bits for all points.
LasGrid lasGridFor(const PointCloud& cloud);

}  // namespace palpate
