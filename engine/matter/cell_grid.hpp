// Cells of a box, and particles sorted by cell, so that neighbours in space are near in memory.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/core/bucket_sort.hpp"
#include "engine/core/vec.hpp"
#include "shaders/shared/matter_cells.h"

namespace palpate {

/// From 0 to `size`, m. Along a periodic axis a particle that leaves through one face re-enters through the other.
struct MatterBox {
  Vec3 size{0};
  std::array<bool, 3> periodic{};
};

/// Cells at least half as wide as `reach`, such that they fill the box. `reach`: m; along periodic axes the box is at
/// least 2.5 times as wide.
shared::MatterCells cellsOf(const MatterBox& box, float reach);
inline std::size_t countOf(const shared::MatterCells& cells) { return numberOf(cells, cells.cells - 1) + 1; }

class CellGrid {
 public:
  explicit CellGrid(const shared::MatterCells& cells);

  /// Sorts the indices of `places` by cell (x fastest, then y), stable within a cell. Positions outside the box, or not
  /// finite, belong to a cell at its border.
  void sort(std::span<const Vec4> places, WorkerTeam& team);
  /// The indices in that order.
  std::span<const std::uint32_t> order() const { return sort_.items(); }

  /// Calls run(begin, end, image) for ranges in the order of sort() that contain everything within the reach of
  /// `place`, and more. Positions of a range are shifted by shiftOf(image).
  template <class Run>
  void forEachRun(const Vec3& place, Run&& run) const;

  const shared::MatterCells& cells() const { return cells_; }
  /// Shift of the periodic image of a neighbour, m.
  Vec3 shiftOf(std::uint32_t image) const { return shifts_[image]; }
  /// Index of each cell's first position in the order, and the total count at the end.
  std::span<const std::uint32_t> firsts() const { return sort_.starts(); }

 private:
  shared::MatterCells cells_;
  std::array<Vec3, shared::kImages> shifts_{};
  BucketSort<std::uint32_t> sort_;
};

template <class Run>
void CellGrid::forEachRun(const Vec3& place, Run&& run) const {
  const IVec3 cell = cellOf(cells_, place);
  for (int row = 0; row < shared::kRowsAbout; ++row) {
    const auto along = [&](int axis, int offset) {
      return shared::cellAlong(cell[axis] + offset - shared::kCellsBeside, cells_.cells[axis],
                               isPeriodic(cells_, axis));
    };
    const shared::CellAlong y = along(1, row % shared::kRowsWide), z = along(2, row / shared::kRowsWide);
    if (y.image == shared::kNoImage || z.image == shared::kNoImage) continue;
    const std::uint32_t* const first = firsts().data() + numberOf(cells_, {0, y.cell, z.cell});
    for (std::uint32_t image = 0; image < shared::kNoImage; ++image) {
      const shared::CellRun x = shared::runAlong(cell.x, cells_.cells.x, isPeriodic(cells_, 0), image);
      if (x.begin < x.end) run(first[x.begin], first[x.end], image + 3 * y.image + 9 * z.image);
    }
  }
}

}  // namespace palpate
