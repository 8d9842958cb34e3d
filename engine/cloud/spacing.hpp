// How far apart the points of a cloud are.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Mean spacing in model units: the square root of the area per point. Coincident points count once; one far outlier
/// changes nothing. 0 for fewer than two different points.
double meanSpacing(const PointCloud& cloud, unsigned threads = 0);

/// Spacings over the regions of a cloud, model units; all 0 for fewer than two different points.
struct SpacingRange {
  double mean = 0;  ///< meanSpacing()
  double wide = 0;  ///< only 2 % of the places have a wider one around them
};
SpacingRange spacingRange(const PointCloud& cloud, unsigned threads = 0);

}  // namespace palpate
