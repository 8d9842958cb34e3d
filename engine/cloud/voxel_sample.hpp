// A coarse sample of a cloud: the mean of its points in each cell of a voxel grid, without outliers.
#pragma once

#include <vector>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct VoxelSample {
  std::vector<Vec3> places;   ///< evenly over the shape, at any density of the points; from the cloud's origin
  std::vector<Vec3> normals;  ///< unit or zero, one for each position if the cloud has normals; else empty
  double cell = 0;            ///< distance between positions, model units
};

/// Deterministic. From a sample: a million points take some milliseconds.
VoxelSample voxelSampleOf(const PointCloud& cloud);

/// The box that a picture should show: that of all points, unless a few isolated points make it much larger. All points
/// within are as in boundsOf().
Bounds coreBoundsOf(const PointCloud& cloud);

}  // namespace palpate
