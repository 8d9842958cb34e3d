// Clouds of uneven density, as scanners leave them.
#pragma once

#include <cstdint>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Positions and normals of a part of `cloud`, which is as dense as before at the low end of its box's longest side and
/// `ratio` times sparser at the high end; the density falls by the same factor over each millimetre. Which points stay
/// is drawn at random from `seed`. `ratio` is at least 1.
PointCloud thinnedAlong(const PointCloud& cloud, double ratio, std::uint64_t seed = 1);

/// The share of points that thinnedAlong() keeps of a cloud that is even along that side.
double shareThatStays(double ratio);

}  // namespace palpate
