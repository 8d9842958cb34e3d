// Triangulates polygons of mesh files.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Larger polygons are assumed to be convex.
inline constexpr std::size_t kLargestConcavePolygon = 256;

/// Adds the triangles of a polygon, given its corners in order; triangles index these corners. Convex polygons become
/// fans, others are triangulated by ear clipping (Meisters 1975) in their best-fitting plane. A polygon may touch
/// itself, and have holes connected by bridges. The number of triangles is that of corners minus two; none for fewer
/// than three corners.
void addPolygon(std::span<const DVec3> around, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace palpate
