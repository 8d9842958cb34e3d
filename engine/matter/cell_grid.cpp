#include "engine/matter/cell_grid.hpp"

#include <algorithm>

namespace palpate {

shared::MatterCells cellsOf(const MatterBox& box, float reach) {
  shared::MatterCells cells{.size = box.size, .periodic = 0, .cellsPerMetre = {}, .cells = {}};
  for (int k = 0; k < 3; ++k) {
    cells.cells[k] = std::max(1, static_cast<int>(box.size[k] / (reach / 2)));
    cells.cellsPerMetre[k] = static_cast<float>(cells.cells[k]) / box.size[k];
    if (box.periodic[static_cast<std::size_t>(k)]) cells.periodic |= 1u << k;
  }
  return cells;
}

CellGrid::CellGrid(const shared::MatterCells& cells) : cells_(cells) {
  for (std::uint32_t image = 0; image < shared::kImages; ++image) shifts_[image] = shared::shiftOf(cells, image);
  first_.resize(countOf(cells) + 1);
}

void CellGrid::sort(std::span<const Vec4> places, std::vector<std::uint32_t>& order) {
  std::ranges::fill(first_, 0);
  cellAt_.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    cellAt_[i] = numberOf(cells_, cellOf(cells_, Vec3(places[i])));
    ++first_[cellAt_[i] + 1];
  }
  for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  order.resize(places.size());
  // Each cell's begin advances to its end, which is the next cell's begin.
  for (std::size_t i = 0; i < places.size(); ++i) order[first_[cellAt_[i]]++] = static_cast<std::uint32_t>(i);
  std::copy_backward(first_.begin(), first_.end() - 1, first_.end());
  first_.front() = 0;
}

}  // namespace palpate
