#include "engine/matter/cell_grid.hpp"

#include <algorithm>

namespace palpate {

CellGrid::CellGrid(const MatterBox& box, float reach) : box_(box) {
  for (int k = 0; k < 3; ++k) {
    cells_[k] = std::max(1, static_cast<int>(box.size[k] / (reach / 2)));
    cellsPerMetre_[k] = static_cast<float>(cells_[k]) / box.size[k];
  }
  for (std::uint32_t image = 0; image < kImages; ++image)
    shifts_[image] = Vec3(IVec3(image % 3, image / 3 % 3, image / 9) - 1) * box.size;
  first_.resize(numberOf(cells_ - 1) + 2);
}

IVec3 CellGrid::cellOf(const Vec3& place) const {
  IVec3 cell{0};
  for (int k = 0; k < 3; ++k) {
    const float along = place[k] * cellsPerMetre_[k];
    // Written so that what is no number comes to the first cell.
    if (along > 0) cell[k] = along < static_cast<float>(cells_[k]) ? static_cast<int>(along) : cells_[k] - 1;
  }
  return cell;
}

CellGrid::Pieces CellGrid::piecesAlong(int axis, int cell) const {
  constexpr int kBeside = 2;  // cells that the reach covers
  const int cells = cells_[axis];
  const int begin = cell - kBeside, end = cell + kBeside + 1;
  Pieces pieces;
  if (box_.periodic[static_cast<std::size_t>(axis)] && begin < 0)
    pieces.piece[static_cast<std::size_t>(pieces.count++)] = {begin + cells, cells, 0};
  pieces.piece[static_cast<std::size_t>(pieces.count++)] = {std::max(begin, 0), std::min(end, cells), 1};
  if (box_.periodic[static_cast<std::size_t>(axis)] && end > cells)
    pieces.piece[static_cast<std::size_t>(pieces.count++)] = {0, end - cells, 2};
  return pieces;
}

void CellGrid::sort(std::span<const Vec4> places, std::vector<std::uint32_t>& order) {
  std::ranges::fill(first_, 0);
  cellAt_.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    cellAt_[i] = static_cast<std::uint32_t>(numberOf(cellOf(Vec3(places[i]))));
    ++first_[cellAt_[i] + 1];
  }
  for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  order.resize(places.size());
  // Each cell's begin walks to its end, which is where the next one begins.
  for (std::size_t i = 0; i < places.size(); ++i) order[first_[cellAt_[i]]++] = static_cast<std::uint32_t>(i);
  std::copy_backward(first_.begin(), first_.end() - 1, first_.end());
  first_.front() = 0;
}

}  // namespace palpate
