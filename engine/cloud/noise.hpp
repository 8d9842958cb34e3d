// How noisy the points of a cloud are: how far they lie off the surface that they sample.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// As many points around a place say how noisy it is: enough to tell noise from curvature, and few, since detail that
/// is as fine as they reach passes for noise.
inline constexpr std::size_t kNoisePoints = 16;

/// The variance of points off the quadric z(x, y) over the plane of their largest extent that fits them best by least
/// squares, squared units of `points`. Unbiased for independent noise: six coefficients are paid for. The quadric takes
/// up slope and curvature, so that exact points of a smooth surface give almost 0. Nothing for fewer than seven points,
/// and where they lie on one line, in one place, or so that the quadric is not unique.
std::optional<double> varianceOffQuadric(std::span<const DVec3> points);

/// The noise that most places bear out, as a deviation in spacings: from the variance of kNoisePoints points at each,
/// over the area per point there. The lower quartile speaks, since edges, thin parts and fine detail can only make a
/// place look noisier than it is. Reorders `variances`; 0 for none.
double noiseFrom(std::vector<double>& variances);

}  // namespace palpate
