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

CellGrid::CellGrid(const shared::MatterCells& cells)
    : cells_(cells), sort_(static_cast<std::uint32_t>(countOf(cells))) {
  for (std::uint32_t image = 0; image < shared::kImages; ++image)
    shifts_[codeOf(image)] = shared::shiftOf(cells, image);
}

void CellGrid::sort(std::span<const Vec4> places, WorkerTeam& team) {
  const auto numberAt = [cells = cells_, places](std::size_t i) {
    return numberOf(cells, cellOf(cells, Vec3(places[i])));
  };
  sort_.sort(places.size(), team, numberAt,
             [](std::size_t i, std::uint32_t& item) { item = static_cast<std::uint32_t>(i); });
}

}  // namespace palpate
