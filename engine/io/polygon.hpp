// Polygons of files of meshes as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Beyond so many corners a polygon is taken for convex.
inline constexpr std::size_t kLargestConcavePolygon = 256;

/// Adds the triangles of a polygon, whose corners are these, in order around it and numbered from 0 on: a fan where no
/// corner points inwards, or else by cutting off ears (Meisters 1975) in the plane that it lies in, as near as that
/// goes. It may touch itself, and have holes to which bridges lead. Two less than corners; none for less than three.
void addPolygon(std::span<const DVec3> around, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace palpate
