// Subsets of points with a minimum distance, and neighbourhood filters.
#pragma once

#include <cstdint>
#include <span>

#include "engine/core/bare_vector.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// The numbers of a maximal set of points at least `distance` apart, ascending: no point can be added to it. Points
/// whose normals are more than a right angle apart are on the two faces of a sheet and may be closer. `distance` is
/// positive. The cells of a grid are processed in eight passes of cells that are not adjacent, so that the result does
/// not depend on `threads` (0: one per core).
BareVector<std::uint32_t> evenlySpaced(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                       unsigned threads = 0);

/// The numbers of the points with at least `fewest` others within `distance` whose normals are less than 60 degrees
/// from theirs, ascending: the other points are not part of a surface. The result does not depend on `threads` (0: one
/// per core).
BareVector<std::uint32_t> inCompany(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                    std::size_t fewest, unsigned threads = 0);

/// For each point the normalised mean of its normal and of those within `distance` that are less than 60 degrees from
/// it. The result does not depend on `threads` (0: one per core).
BareVector<Vec3> smoothedNormals(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                 unsigned threads = 0);

}  // namespace palpate
