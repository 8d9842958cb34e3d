#pragma once

#include <span>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Takes the points of a GPU's copy back into the cloud that it was made from: `positions` hold xyz and the bits of the
/// point's number, `normals` xyz, one of each for every point, in any order. Says how many points stand elsewhere.
std::size_t takeBack(PointCloud& cloud, std::span<const Vec4> positions, std::span<const Vec4> normals);

}  // namespace palpate
