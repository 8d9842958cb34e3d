// The grid of the spatial hash on the CPU: the same cells and buckets, bit for bit, as shaders/lib/hash_grid.glsl.
#pragma once

#include <cstdint>

#include "engine/cloud/point_cloud.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

using shared::HashGrid;

IVec3 cellOf(const HashGrid& grid, const Vec3& position);
std::uint32_t bucketOf(const HashGrid& grid, const IVec3& cell);

/// Bits of a bucket number.
std::uint32_t bucketBits(const HashGrid& grid);

/// A grid for `count` points with cells of edge `cell` (model units, positive). About four points share a bucket: on a
/// surface with cells of the support radius that is one occupied cell for every four buckets or so.
HashGrid makeHashGrid(const Vec3& origin, double cell, std::uint64_t count);

}  // namespace palpate
