// Some points of a cloud as a cloud of their own.
#pragma once

#include <span>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_set.hpp"

namespace palpate {

/// The points of a set, in their order, with all that they have, bit by bit. Numbers beyond the cloud are not allowed.
PointCloud chosenPoints(const PointCloud& cloud, const PointSet& which, unsigned threads = 0);

/// The triangles of which all corners are among these points (ascending), by the index that the corners have there.
std::vector<std::array<std::uint32_t, 3>> chosenTriangles(std::span<const std::array<std::uint32_t, 3>> triangles,
                                                          std::span<const std::uint32_t> points);

/// All points of a cloud of `count` but those of a set.
PointSet othersThan(const PointSet& which, std::uint64_t count);

}  // namespace palpate
