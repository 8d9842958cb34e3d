#include "engine/core/connected_cells.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

namespace {

// A row is the cells along x: its bits, in half a word.
constexpr int kSide = static_cast<int>(shared::kSheetSide);
constexpr std::size_t kRows = shared::kSheetSide * shared::kSheetSide;
static_assert(shared::kSheetSide == 16);
using Rows = std::array<std::uint16_t, kRows>;

Rows rowsOf(const SheetCells& cells) {
  Rows rows;
  for (std::size_t i = 0; i < kRows; ++i) rows[i] = static_cast<std::uint16_t>(cells[i / 2] >> (i % 2 * 16));
  return rows;
}

SheetCells cellsOf(const Rows& rows) {
  SheetCells cells{};
  for (std::size_t i = 0; i < kRows; ++i) cells[i / 2] |= std::uint32_t{rows[i]} << (i % 2 * 16);
  return cells;
}

std::uint16_t spread(std::uint16_t row) { return static_cast<std::uint16_t>(row | row << 1 | row >> 1); }

// Calls visit(row) for a row and the eight around it.
template <class Visit>
void forEachAdjacent(std::size_t row, Visit&& visit) {
  const int y = static_cast<int>(row) % kSide, z = static_cast<int>(row) / kSide;
  for (int k = std::max(z - 1, 0); k <= std::min(z + 1, kSide - 1); ++k)
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, kSide - 1); ++j)
      visit(shared::kSheetSide * static_cast<std::size_t>(k) + static_cast<std::size_t>(j));
}

}  // namespace

SheetCells cellsAround(const DVec3& place) noexcept {
  const shared::uint cell = shared::sheetCellAt<double>(place);
  Rows rows{};
  const auto bit = static_cast<std::uint16_t>(1u << cell % shared::kSheetSide);
  forEachAdjacent(cell / shared::kSheetSide, [&](std::size_t row) { rows[row] = spread(bit); });
  return cellsOf(rows);
}

SheetCells connectedCells(const SheetCells& occupied, shared::uint first) noexcept {
  const Rows rows = rowsOf(occupied);
  Rows reached{};
  std::array<std::uint8_t, kRows> waiting;  // rows whose neighbours have still to be visited, each once
  std::array<bool, kRows> waits{};
  std::size_t count = 0;
  const auto reach = [&](std::size_t row, std::uint16_t cells) {
    for (std::uint16_t more = cells; more != 0;) {
      cells |= more;
      more = static_cast<std::uint16_t>(spread(cells) & rows[row] & ~cells);
    }
    reached[row] |= cells;
    if (std::exchange(waits[row], true)) return;
    waiting[count++] = static_cast<std::uint8_t>(row);
  };
  reach(first / shared::kSheetSide, static_cast<std::uint16_t>(1u << first % shared::kSheetSide));
  while (count > 0) {
    const std::size_t row = waiting[--count];
    waits[row] = false;
    const std::uint16_t beside = spread(reached[row]);
    forEachAdjacent(row, [&](std::size_t other) {
      const auto cells = static_cast<std::uint16_t>(beside & rows[other] & ~reached[other]);
      if (cells != 0) reach(other, cells);
    });
  }
  return cellsOf(reached);
}

}  // namespace palpate
