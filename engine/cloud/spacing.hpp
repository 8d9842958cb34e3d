// How far apart the points of a cloud are, and how far off their surface.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Mean spacing in model units: the square root of the area per point. Coincident points count once; one far outlier
/// changes nothing. 0 for fewer than two different points.
double meanSpacing(const PointCloud& cloud, unsigned threads = 0);

/// Over the regions of a cloud; all 0 for fewer than two different points.
struct SpacingRange {
  double mean = 0;  ///< meanSpacing(), model units
  double wide = 0;  ///< only 2 % of the places have a wider one around them; model units
  /// Deviation of the points from their surface in one direction (noiseFrom()), in spacings of the place: almost 0 for
  /// exact points, but for folds as fine as the spacing. Within 10 % up to half a spacing; a thicker sheet is no
  /// surface, and comes out thinner than it is. 0 for fewer than kNoisePoints different points.
  double noise = 0;
};
SpacingRange spacingRange(const PointCloud& cloud, unsigned threads = 0);

}  // namespace palpate
