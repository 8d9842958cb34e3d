// Clouds of uneven density, as from scanners.
#pragma once

#include <cstdint>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Positions and normals of a subset of `cloud`, which keeps its density at the low end of its box's longest side and
/// is `ratio` times sparser at the high end; the density falls exponentially in between. The subset is random, from
/// `seed`. `ratio` is at least 1.
PointCloud thinnedAlong(const PointCloud& cloud, double ratio, std::uint64_t seed = 1);

/// The share of points that thinnedAlong() keeps of a cloud that is even along that side.
double shareThatStays(double ratio);

}  // namespace palpate
