#pragma once

#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

/// position = scale * (rotation * position before), about the means.
struct Similarity {
  DQuat rotation{1, 0, 0, 0};
  double scale = 1;
  double misfit = 0;  ///< root mean square of what is left, in radii (the same mean) of the points
};

/// The similarity that takes points nearest to others, one for each (Horn 1987, "Closed-form solution of absolute
/// orientation using unit quaternions"). At least three, not on a line.
Similarity nearestSimilarity(std::span<const DVec3> before, std::span<const DVec3> now);

}  // namespace palpate
