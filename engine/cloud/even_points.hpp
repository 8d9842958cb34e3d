// Points of which none stand too close together.
#pragma once

#include <cstdint>
#include <span>

#include "engine/core/bare_vector.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// The numbers of as many points as can stand `distance` apart from each other, ascending: none could be added. Points
/// whose normals are more than a right angle apart are of two faces of a sheet, and may stand closer. `distance` is
/// positive. The cells of a grid are gone through in eight passes, in each of them cells that are no neighbours, so
/// that the result does not depend on `threads` (0: one per core).
BareVector<std::uint32_t> evenlySpaced(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                       unsigned threads = 0);

/// The numbers of the points that have `fewest` others within `distance` whose normals are less than 60 degrees from
/// theirs, ascending: the others are of no surface. The result does not depend on `threads` (0: one per core).
BareVector<std::uint32_t> inCompany(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                    std::size_t fewest, unsigned threads = 0);

/// For each point the mean, of unit length, of its normal and of those within `distance` that are less than 60 degrees
/// from it. The result does not depend on `threads` (0: one per core).
BareVector<Vec3> smoothedNormals(std::span<const Vec3> points, std::span<const Vec3> normals, float distance,
                                 unsigned threads = 0);

}  // namespace palpate
