// Cells of a cubic grid by Morton codes of 63 bits (Morton 1966): cells that share all but the last 3 k bits form a
// cell of 2^k times the side, so that one sort serves grids of many sizes.
#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/core/vec.hpp"

namespace palpate {

inline constexpr int kMortonBits = 21;  // of each coordinate
/// Cells extend this far to both sides of the origin; positions farther away are in the outermost cells.
inline constexpr std::int32_t kMortonReach = 1 << (kMortonBits - 1);

/// The bits of a coordinate, with two zeros after each.
inline std::uint64_t spreadBits(std::uint64_t v) {
  v &= 0x1FFFFF;
  v = (v | v << 32) & 0x001F00000000FFFFull;
  v = (v | v << 16) & 0x001F0000FF0000FFull;
  v = (v | v << 8) & 0x100F00F00F00F00Full;
  v = (v | v << 4) & 0x10C30C30C30C30C3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

/// Inverse of spreadBits(): every third bit.
inline std::uint64_t gatherBits(std::uint64_t v) {
  v &= 0x1249249249249249ull;
  v = (v | v >> 2) & 0x10C30C30C30C30C3ull;
  v = (v | v >> 4) & 0x100F00F00F00F00Full;
  v = (v | v >> 8) & 0x001F0000FF0000FFull;
  v = (v | v >> 16) & 0x001F00000000FFFFull;
  return (v | v >> 32) & 0x1FFFFF;
}

inline std::uint64_t mortonCode(const IVec3& cell) {
  return spreadBits(static_cast<std::uint64_t>(cell.x)) | spreadBits(static_cast<std::uint64_t>(cell.y)) << 1 |
         spreadBits(static_cast<std::uint64_t>(cell.z)) << 2;
}

/// The coordinates, from 0 on, of the cell of side `side` that contains a position.
inline IVec3 mortonCell(const Vec3& place, float side) {
  IVec3 cell;
  for (int k = 0; k < 3; ++k) {
    const auto reach = static_cast<float>(kMortonReach);
    const float at = std::clamp(place[k] / side, -reach, reach - 1);
    const auto whole = static_cast<std::int32_t>(at);  // towards zero: std::floor() is a call on older processors
    cell[k] = whole - (at < static_cast<float>(whole) ? 1 : 0) + kMortonReach;
  }
  return cell;
}

/// The cell of a code.
inline IVec3 mortonCellOf(std::uint64_t code) {
  IVec3 cell;
  for (int k = 0; k < 3; ++k) cell[k] = static_cast<std::int32_t>(gatherBits(code >> k));
  return cell;
}

}  // namespace palpate
