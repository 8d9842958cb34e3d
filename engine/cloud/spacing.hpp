// Spacing of a cloud's points, and their distance from their surface.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Noise of a cloud: the distance of its points from the surface that they sample.
/// Number of points around a position used to estimate its noise: enough to distinguish noise from curvature, and few,
/// since detail finer than their extent counts as noise.
inline constexpr std::size_t kNoisePoints = 16;

/// The variance of points about the least-squares quadric z(x, y) over the plane of their largest extent, squared units
/// of `points`. Unbiased for independent noise: corrected for six coefficients. The quadric absorbs slope and
/// curvature, so that exact points of a smooth surface give almost 0. Empty for fewer than seven points, and if they
/// lie on one line, in one position, or so that the quadric is not unique.
std::optional<double> varianceOffQuadric(std::span<const DVec3> points);

/// The typical noise as a standard deviation in spacings: from the variance of kNoisePoints points at each position,
/// over the local area per point. Uses the lower quartile, since edges, thin parts and fine detail can only increase
/// the apparent noise. Reorders `variances`; 0 if empty.
double noiseFrom(std::vector<double>& variances);

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
