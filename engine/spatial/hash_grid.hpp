#pragma once

#include <cstdint>

#include "engine/cloud/point_cloud.hpp"
#include "shaders/shared/hash_grid.h"

namespace palpate {

using shared::bucketOf;
using shared::cellOf;
using shared::HashGrid;

/// How cells become buckets: each cell scattered by Teschner's hash (the thesis), or blocks of eight cells a side
/// scattered and the cells within a block in Morton order.
enum class BucketKey { teschner, morton };

/// Bits of a bucket number.
std::uint32_t bucketBits(const HashGrid& grid);

/// A grid for `count` points with cells of edge `cell` (model units, positive). About four points share a bucket: on a
/// surface with cells of the support radius that is one occupied cell for every four buckets or so.
HashGrid makeHashGrid(const Vec3& origin, double cell, std::uint64_t count, BucketKey key = BucketKey::teschner);

}  // namespace palpate
