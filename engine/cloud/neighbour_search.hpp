// What the CPU's neighbourhood searches have in common: PointTree, SortedGrid and those of the study. Each has
//   build(positions)             sets the points, whose number is their index; keeps a view, which must stay valid
//   move(moves)                  follows points that have moved in the positions, each at most once
//   near(center, radius, found)  appends every point strictly nearer, once, in any order; distances in double precision
//   bytes()                      memory in addition to the positions
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A point that has moved: its number, and its previous position.
struct PointMove {
  std::uint32_t point;
  Vec3 from;
};

}  // namespace palpate
