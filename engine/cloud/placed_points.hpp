#pragma once

#include <span>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Copies the points of a GPU back into the cloud that they came from: `positions` hold xyz and the bits of the point's
/// number, `normals` xyz, one of each for every point, in any order. Returns the number of points that have moved.
std::size_t takeBack(PointCloud& cloud, std::span<const Vec4> positions, std::span<const Vec4> normals);

}  // namespace palpate
