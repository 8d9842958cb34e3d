// The part of a surface that is connected with a position on it, by the cells of a grid (shaders/shared/sheet_grid.h).
#pragma once

#include <array>
#include <cstdint>

#include "engine/core/vec.hpp"
#include "shaders/shared/brush.h"

namespace palpate {

/// One bit for each cell, as sheetCellAt() numbers them.
using SheetCells = std::array<std::uint32_t, shared::kSheetWords>;

inline bool hasCell(const SheetCells& cells, shared::uint cell) { return (cells[cell / 32] >> cell % 32 & 1) != 0; }

/// Middle of a cell, in cells from the grid's corner.
inline DVec3 sheetCellMiddle(shared::uint cell) {
  const shared::uint side = shared::kSheetSide;
  return DVec3(cell % side, cell / side % side, cell / (side * side)) + 0.5;
}

/// The cell at `place`, in cells from the grid's corner, and the cells adjacent to it, also across edges and corners.
SheetCells cellsAround(const DVec3& place) noexcept;

/// The cells of `occupied` that are connected with `first`, which is one of them: each adjacent to another, also across
/// edges and corners. Allocates nothing.
SheetCells connectedCells(const SheetCells& occupied, shared::uint first) noexcept;

}  // namespace palpate
