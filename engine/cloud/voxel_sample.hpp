// A coarse sample of a cloud: the mean of its points in each cell of a voxel grid, without outliers.
#pragma once

#include <functional>
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

/// The box that a picture should show and a hand's scale fits: that of all points, unless a few isolated points make it
/// much larger; then that of the points without them. As boundsOf() in all else.
Bounds coreBoundsOf(const PointCloud& cloud);
/// originFor() the box of `count` positions, or of those without a few far outliers, around which single precision
/// would be coarse. `box`: of all of them.
DVec3 originOf(std::size_t count, const Bounds& box, const std::function<DVec3(std::size_t)>& positionOf);
/// Number of points outside a box.
std::size_t countOutside(const PointCloud& cloud, const Bounds& box);

}  // namespace palpate
