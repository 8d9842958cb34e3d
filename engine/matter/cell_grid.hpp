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
  /// positions in a row of cells along x, from `cell` to that with x = `lastX`, and more. Positions of a range are
  /// shifted by shiftOf(image); image 0 is the box itself.
  template <class Run>
  void forEachRun(const IVec3& cell, int lastX, Run&& run) const;
  /// The same for one position.
  template <class Run>
  void forEachRun(const Vec3& place, Run&& run) const {
    const IVec3 cell = cellOf(cells_, place);
    forEachRun(cell, cell.x, run);
  }
  /// The same in a box that is not periodic, and with more than is near: run(begin, end) for each plane of cells.
  template <class Run>
  void forEachPlane(const Vec3& place, Run&& run) const;

  const shared::MatterCells& cells() const { return cells_; }
  /// Shift of the periodic image of a neighbour, m.
  Vec3 shiftOf(std::uint32_t image) const { return shifts_[image]; }
  /// Index of each cell's first position in the order, and the total count at the end.
  std::span<const std::uint32_t> firsts() const { return sort_.starts(); }

 private:
  // The box itself is 0.
  static std::uint32_t codeOf(std::uint32_t image) {
    return image >= shared::kItself ? image - shared::kItself : image + shared::kImages - shared::kItself;
  }

  shared::MatterCells cells_;
  std::array<Vec3, shared::kImages> shifts_{};
  BucketSort<std::uint32_t> sort_;
};

template <class Run>
void CellGrid::forEachPlane(const Vec3& place, Run&& run) const {
  const IVec3 cell = cellOf(cells_, place), low = glm::max(cell - shared::kCellsBeside, IVec3(0)),
              high = glm::min(cell + shared::kCellsBeside, cells_.cells - 1);
  for (int z = low.z; z <= high.z; ++z)
    run(firsts()[numberOf(cells_, {0, low.y, z})], firsts()[numberOf(cells_, {cells_.cells.x - 1, high.y, z}) + 1]);
}

template <class Run>
void CellGrid::forEachRun(const IVec3& cell, int lastX, Run&& run) const {
  // Cells along y or z that are near, and the runs of cells along x.
  struct Beside {
    std::array<shared::CellAlong, shared::kRowsWide> cells;
    std::size_t count = 0;
  };
  std::array<Beside, 2> beside;
  for (int axis = 1; axis < 3; ++axis)
    for (int offset = -shared::kCellsBeside; offset <= shared::kCellsBeside; ++offset) {
      Beside& along = beside[static_cast<std::size_t>(axis - 1)];
      along.cells[along.count] = shared::cellAlong(cell[axis] + offset, cells_.cells[axis], isPeriodic(cells_, axis));
      along.count += along.cells[along.count].image != shared::kNoImage ? 1 : 0;
    }
  std::array<shared::CellRun, shared::kNoImage> runs;
  for (std::uint32_t image = 0; image < shared::kNoImage; ++image) {
    const shared::CellRun first = shared::runAlong(cell.x, cells_.cells.x, isPeriodic(cells_, 0), image);
    const shared::CellRun last = shared::runAlong(lastX, cells_.cells.x, isPeriodic(cells_, 0), image);
    const bool any = first.begin < first.end || last.begin < last.end;
    runs[image] = {.begin = first.begin, .end = any ? last.end : first.begin};
  }
  for (const shared::CellAlong& z : std::span(beside[1].cells).first(beside[1].count))
    for (const shared::CellAlong& y : std::span(beside[0].cells).first(beside[0].count)) {
      const std::uint32_t* const first = firsts().data() + numberOf(cells_, {0, y.cell, z.cell});
      for (std::uint32_t image = 0; image < shared::kNoImage; ++image)
        if (const shared::CellRun& x = runs[image]; x.begin < x.end)
          run(first[x.begin], first[x.end], codeOf(image + 3 * y.image + 9 * z.image));
    }
}

}  // namespace palpate
