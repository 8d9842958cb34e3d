// Spacing of a cloud's points, and their distance from their surface.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Mean spacing in model units: the square root of the area per point. Coincident points count once; a far outlier has
/// no effect. 0 for fewer than two distinct points. `points`: of a larger cloud about so many, a random choice, are
/// looked at, a million at most.
double meanSpacing(const PointCloud& cloud, unsigned threads = 0, std::size_t points = 1'000'000);
/// The same from fewer points, in at most a tenth of a second: for searches that are right with any spacing.
double roughSpacing(const PointCloud& cloud, unsigned threads = 0);

/// Over the regions of a cloud; all 0 for fewer than two distinct points.
struct SpacingRange {
  double mean = 0;  ///< meanSpacing(), model units
  /// 98th percentile of the local spacing by points, or the 90th by area if that is more: a part with few points may be
  /// large. Model units.
  double wide = 0;
  /// Standard deviation of the points from their surface in one direction (noiseFrom()), in local spacings: almost 0
  /// for exact points, except for folds as fine as the spacing. Accurate to 10 % up to half a spacing; a thicker layer
  /// is not a surface, and is underestimated. 0 for fewer than kNoisePoints distinct points.
  double noise = 0;
};
SpacingRange spacingRange(const PointCloud& cloud, unsigned threads = 0);

}  // namespace palpate
