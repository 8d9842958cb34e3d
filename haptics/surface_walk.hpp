// Walks over a cloud: steps in the tangent plane, with a projection onto the surface after each.
#pragma once

#include <vector>

#include "haptics/thinned_cloud.hpp"

namespace palpate {

/// Model units, relative to the cloud's origin.
struct SurfaceSpot {
  DVec3 position{0};
  DVec3 normal{0};        ///< unit, outward
  bool supported = true;  ///< false: beyond the border of the points; the last plane was extended
};

/// Projects `p` onto the surface near it that faces the same way as `facing`.
SurfaceSpot settle(const ThinnedCloud& sample, const DVec3& p, const DVec3& facing);

/// From `start` in the tangent direction `direction`, which rotates with the surface: `steps` spots, each `step` after
/// the previous one, without the start.
std::vector<SurfaceSpot> walk(const ThinnedCloud& sample, const SurfaceSpot& start, const DVec3& direction, double step,
                              std::size_t steps);

}  // namespace palpate
