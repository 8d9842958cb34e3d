#include "engine/matter/rest_shape.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

// Minimum volume spanned by a corner of a cell, relative to the lattice: below it points would coincide at rest.
constexpr double kMinCorner = 0.1;
// Maximum stiffness per mass, relative to a cube: more would need many more substeps.
constexpr double kMaxStiffness = 4;
constexpr double kMaxVolume = 8;

const shared::CellRest kCube{
    .inverse = glm::mat3(1), .bent = {Vec3(0), Vec3(0), Vec3(0), Vec3(0)}, .volume = 1, .bend = 1};

// The product of the maximum row and column sums bounds the squared norm of a matrix (Golub, Van Loan); exact for
// diagonal matrices.
double mostSquared(const glm::mat3& matrix) {
  double rows = 0, columns = 0;
  for (int a = 0; a < 3; ++a) {
    double row = 0, column = 0;
    for (int b = 0; b < 3; ++b) {
      row += std::abs(static_cast<double>(matrix[b][a]));
      column += std::abs(static_cast<double>(matrix[a][b]));
    }
    rows = std::max(rows, row);
    columns = std::max(columns, column);
  }
  return rows * columns;
}

void setLane(Lanes& lanes, std::size_t lane, float value) {
  std::array<float, Lanes::kCount> values;
  lanes.writeTo(values.data());
  values[lane] = value;
  lanes = Lanes(values);
}

void setLane(RestShape::CellRestOfLanes& group, std::size_t lane, const shared::CellRest& cell) {
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) setLane(group.inverse[column][row], lane, cell.inverse[column][row]);
  for (int mode = 0; mode < 4; ++mode)
    for (int axis = 0; axis < 3; ++axis) setLane(group.bent[mode][axis], lane, cell.bent[mode][axis]);
  setLane(group.volume, lane, cell.volume);
  setLane(group.bend, lane, cell.bend);
}

}  // namespace

RestShape::RestShape(const SoftLattice& lattice, const shared::SoftRules& rules)
    : lattice_(lattice), rules_(rules), incident_(lattice.incident()), moved_(lattice.nodes(), Vec3(0)) {}

const shared::CellRest* RestShape::ofCell(std::size_t cell) const {
  return isSculpted() && stiffnesses_[cell] > 0 ? &ofCells_[cell] : nullptr;
}

const RestShape::CellRestOfLanes* RestShape::ofGroup(std::size_t group) const {
  return isSculpted() && groupIsSculpted_[group] != 0 ? &ofGroups_[group] : nullptr;
}

glm::mat3 RestShape::elastic(std::size_t cell, const shared::Corners& modes) const {
  const shared::CellRest* const rest = ofCell(cell);
  return rest ? shared::sculptedGradient(rules_, *rest, modes) : shared::gradientOf(rules_, modes) + glm::mat3(1);
}

RestShape::CellNow RestShape::cellNow(std::size_t cell) const {
  shared::Corners modes;
  CellNow now{.rest = kCube};
  for (std::size_t k = 0; k < 8; ++k) {
    modes.at[k] = moved_[lattice_.corners()[cell][k]];
    now.isCube &= modes.at[k] == Vec3(0);
  }
  if (now.isCube) return now;
  shared::takeModes(modes);
  now.rest = shared::cellRestOf(rules_, modes);
  double bent = 0;  // a mode with an amplitude of one spacing has the value 8 spacings
  for (const Vec3& mode : now.rest.bent)
    bent += glm::dot(DVec3(mode), DVec3(mode)) / std::pow(8 * lattice_.spacing_m(), 2);
  now.stiffness = static_cast<float>(static_cast<double>(now.rest.volume) * mostSquared(now.rest.inverse) * (1 + bent));
  return now;
}

bool RestShape::holds(std::size_t cell) const {
  const SoftLattice::Corners& nodes = lattice_.corners()[cell];
  const auto at = [&](unsigned corner) {
    const DVec3 place(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    return place + DVec3(moved_[nodes[corner]]) / lattice_.spacing_m();
  };
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto edge = [&](unsigned axis) {
      return ((corner & axis) != 0 ? -1.0 : 1.0) * (at(corner ^ axis) - at(corner));
    };
    if (!(glm::dot(edge(1), glm::cross(edge(2), edge(4))) >= kMinCorner)) return false;
  }
  const CellNow now = cellNow(cell);
  return static_cast<double>(now.stiffness) <= kMaxStiffness && static_cast<double>(now.rest.volume) <= kMaxVolume &&
         static_cast<double>(now.rest.volume) >= kMinCorner;
}

std::size_t RestShape::yield(std::span<const RestPlace> places) {
  std::vector<Vec3> before;
  std::vector<std::uint32_t> cells;
  for (const RestPlace& place : places) {
    before.push_back(moved_[place.node]);
    moved_[place.node] = place.moved;
    for (const std::uint32_t slot : incident_[place.node])
      if (slot / 8 < lattice_.cells()) cells.push_back(slot / 8);
  }
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  // A node that stays affects other cells: repeats until all cells are valid or unchanged.
  std::vector<char> stays(places.size(), 0);
  for (bool again = true; again;) {
    again = false;
    for (const std::uint32_t cell : cells) {
      if (holds(cell)) continue;
      for (std::size_t k = 0; k < places.size(); ++k) {
        if (stays[k] != 0 ||
            std::ranges::find(lattice_.corners()[cell], places[k].node) == lattice_.corners()[cell].end())
          continue;
        moved_[places[k].node] = before[k];
        stays[k] = 1;
        again = true;
      }
    }
  }
  follow(places);
  return static_cast<std::size_t>(std::ranges::count(stays, 0));
}

void RestShape::put(std::span<const RestPlace> places) {
  for (const RestPlace& place : places) moved_[place.node] = place.moved;
  follow(places);
}

// Updates the cells around these nodes.
void RestShape::follow(std::span<const RestPlace> places) {
  if (places.empty()) return;
  if (!isSculpted()) {
    const std::size_t groups = (lattice_.cells() + Lanes::kCount - 1) / Lanes::kCount;
    ofCells_.assign(lattice_.cells(), kCube);
    stiffnesses_.assign(lattice_.cells(), 0);
    CellRestOfLanes cubes{};
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) setLane(cubes, lane, kCube);
    ofGroups_.assign(groups, cubes);
    groupIsSculpted_.assign(groups, 0);
  }
  for (const RestPlace& place : places)
    for (const std::uint32_t slot : incident_[place.node]) {
      const std::size_t cell = slot / 8, group = cell / Lanes::kCount;
      if (cell == lattice_.cells()) continue;
      const CellNow now = cellNow(cell);
      ofCells_[cell] = now.rest;
      stiffnesses_[cell] = now.isCube ? 0 : now.stiffness;
      setLane(ofGroups_[group], cell % Lanes::kCount, now.rest);
      const std::size_t first = group * Lanes::kCount, end = std::min(first + Lanes::kCount, lattice_.cells());
      groupIsSculpted_[group] = std::ranges::any_of(stiffnesses_.begin() + static_cast<std::ptrdiff_t>(first),
                                                    stiffnesses_.begin() + static_cast<std::ptrdiff_t>(end),
                                                    [](float stiffness) { return stiffness > 0; })
                                    ? 1
                                    : 0;
    }
  stiffest_ = std::max(1.0, static_cast<double>(*std::ranges::max_element(stiffnesses_)));
}

}  // namespace palpate
