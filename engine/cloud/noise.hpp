// Noise of a cloud: the distance of its points from the surface that they sample.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

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

}  // namespace palpate
