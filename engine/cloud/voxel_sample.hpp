// A coarse sample of a cloud: the mean of its points in each cell of a voxel grid, without outliers.
#pragma once

#include <vector>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct VoxelSample {
  std::vector<Vec3> places;   ///< evenly over the shape however uneven the points are; relative to the cloud's origin
  std::vector<Vec3> normals;  ///< unit or zero, one for each place where the cloud has normals; else empty
  double cell = 0;            ///< how far apart places are, model units
};

/// The same for the same cloud. From a sample: a million points take some milliseconds.
VoxelSample voxelSampleOf(const PointCloud& cloud);

/// The box that a picture should show: that of all points, unless a few that lie far from all others make it much
/// larger. All points within are as in boundsOf().
Bounds coreBoundsOf(const PointCloud& cloud);

}  // namespace palpate
