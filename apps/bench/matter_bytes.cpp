#include "apps/bench/matter_bytes.hpp"

#include <cmath>

#include "engine/matter/cell_grid.hpp"
#include "engine/matter/matter_rules.hpp"
#include "shaders/shared/matter_state.h"

namespace palpate {

namespace {

constexpr double kPlace = 16, kWord = 4, kContact = 16;  // bytes
constexpr double kGrainContacts = 6;                     // contacts of a grain on the lattice

// Number of positions of a cubic lattice of spacing 1 within that distance of one of them.
double neighboursWithin(double spacings) {
  const int far = static_cast<int>(std::ceil(spacings));
  int count = 0;
  for (int z = -far; z <= far; ++z)
    for (int y = -far; y <= far; ++y)
      for (int x = -far; x <= far; ++x) count += x * x + y * y + z * z <= spacings * spacings ? 1 : 0;
  return count - 1;
}

}  // namespace

std::map<std::string, PassBytes> matterBytes(const MatterScene& scene, std::size_t particles) {
  const double spacing_m = scene.spacing_mm * 1e-3, n = static_cast<double>(particles);
  const double listed_spacings = double{reachOf(scene.matter).neighbour_spacings} + double{kListedFarther_spacings};
  const shared::MatterCells grid = cellsOf({.size = scene.box_mm * 1e-3, .periodic = scene.periodic},
                                           static_cast<float>(listed_spacings * spacing_m));
  const DVec3 cells(grid.cells);
  const double firsts = kWord * cells.x * cells.y * cells.z;  // start of each cell
  // Neighbours are listed and read in fours; to find them, all particles within some cells are read.
  const double listed = neighboursWithin(listed_spacings), fours = shared::kListedAtOnce;
  const double asked = std::ceil(listed / fours) * fours, list = kWord * asked;
  const double lookedAt = std::pow(shared::kRowsWide * listed_spacings / 2, 3);
  const auto each = [&](double bytes, double byNeighbours = 0, double once = 0) {
    return PassBytes{.moved = n * bytes + once, .asked = n * (bytes + byNeighbours) + once};
  };
  std::map<std::string, PassBytes> passes{
      // Velocity, position, listed position; predicted position. All cells are cleared.
      {"matter_predict", each(4 * kPlace, 0, firsts)},
      {"matter_count", each(kPlace + 2 * kWord, 0, 2 * firsts)},
      {"matter_scan_reduce", each(0, 0, firsts)},
      {"matter_scan", each(0, 0, 2 * firsts)},
      {"matter_place", each(3 * kWord, 0, firsts)},
      // Position in the order, cell; three vectors and an id, from their old slot to their new one.
      {"matter_sort", each(2 * kWord + 2 * (3 * kPlace + kWord), 0, firsts)},
      {"matter_list", each(2 * (3 * kPlace + kWord) + list + kWord, kPlace * lookedAt, firsts)}};
  for (auto& [name, bytes] : passes) bytes.earlyExit = name != "matter_predict";
  if (scene.matter == Matter::sand) {
    // Position, velocity, id, list, contacts; position, velocity and contacts, written to other buffers.
    const double contacts = kContact * kGrainContacts + kWord;
    passes["matter_rub"] = each(2 * kPlace + kWord + list + kWord + contacts + 2 * kPlace + contacts,
                                kPlace * listed + (kPlace + kWord) * kGrainContacts);
    return passes;
  }
  passes["matter_compress"] = each(kPlace + list + kWord + kPlace, kPlace * asked);
  passes["matter_push"] = each(2 * kPlace + list + kWord + 2 * kPlace, 2 * kPlace * asked);
  return passes;
}

}  // namespace palpate
