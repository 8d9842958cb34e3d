#include "engine/matter/soft_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/core/check.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kMaxBoxCells = 64e6;  // maximum number of cells of the box
constexpr float kMinFilled = 0.2f;
constexpr int kFarthestCell = 8;  // maximum distance from an embedded position, in cells
// Samples along each axis in a cell that the surface of a ball may cross.
constexpr int kBallSamples = 6;

IVec3 cornerOf(int corner) { return {corner & 1, corner >> 1 & 1, corner >> 2 & 1}; }

}  // namespace

LatticeBox LatticeBox::about(const DVec3& low_m, const DVec3& high_m, double spacing_m) {
  LatticeBox box{.corner = low_m, .spacing_m = spacing_m};
  double count = 1;
  for (int k = 0; k < 3; ++k) {
    const double along = std::max(1.0, std::ceil((high_m[k] - low_m[k]) / spacing_m - 1e-6));
    count *= along;
    if (!(count <= kMaxBoxCells)) throw Error("spacing_mm: makes more than {:g} cells; use a larger one", kMaxBoxCells);
    box.cells[k] = static_cast<int>(along);
  }
  box.filled.assign(static_cast<std::size_t>(count), 0);
  return box;
}

IVec3 LatticeBox::cellOf(std::size_t number) const {
  const auto x = static_cast<std::size_t>(cells.x), y = static_cast<std::size_t>(cells.y);
  return {static_cast<int>(number % x), static_cast<int>(number / x % y), static_cast<int>(number / x / y)};
}

IVec3 LatticeBox::cellAt(const DVec3& place_m) const { return {glm::floor((place_m - corner) / spacing_m)}; }

SoftLattice::SoftLattice(LatticeBox box, std::span<const std::size_t> kept) : box_(std::move(box)) {
  cellAt_.assign(box_.filled.size(), kNone);
  for (const std::size_t number : kept) cellAt_[number] = 0;
  const IVec3 places = box_.cells + 1;
  const LatticeBox nodeBox{.cells = places};
  std::vector<std::uint32_t> nodeAt(
      static_cast<std::size_t>(places.x) * static_cast<std::size_t>(places.y) * static_cast<std::size_t>(places.z),
      kNone);
  const double cube = std::pow(box_.spacing_m, 3);
  for (std::size_t c = 0; c < cellAt_.size(); ++c) {
    volume_m3_ += cube * static_cast<double>(box_.filled[c]);
    if (cellAt_[c] == kNone && !(box_.filled[c] > 0)) continue;
    cellAt_[c] = static_cast<std::uint32_t>(filled_.size());
    filled_.push_back(std::max(box_.filled[c], kMinFilled));
    for (int k = 0; k < 8; ++k) nodeAt[nodeBox.numberOf(box_.cellOf(c) + cornerOf(k))] = 0;
  }
  for (std::size_t n = 0; n < nodeAt.size(); ++n) {
    if (nodeAt[n] == kNone) continue;
    nodeAt[n] = static_cast<std::uint32_t>(rest_.size());
    rest_.emplace_back(box_.corner + box_.spacing_m * DVec3(nodeBox.cellOf(n)));
  }
  for (std::size_t c = 0; c < cellAt_.size(); ++c) {
    if (cellAt_[c] == kNone) continue;
    Corners& corners = corners_.emplace_back();
    for (int k = 0; k < 8; ++k)
      corners[static_cast<std::size_t>(k)] = nodeAt[nodeBox.numberOf(box_.cellOf(c) + cornerOf(k))];
  }
}

std::vector<SoftLattice::Corners> SoftLattice::incident() const {
  Corners none;
  none.fill(static_cast<std::uint32_t>(8 * cells()));
  std::vector<Corners> incident(nodes(), none);
  for (std::size_t c = 0; c < cells(); ++c)
    for (std::size_t k = 0; k < 8; ++k) incident[corners_[c][k]][7 - k] = static_cast<std::uint32_t>(8 * c + k);
  return incident;
}

std::vector<double> SoftLattice::nodeShares() const {
  double all = 0;
  for (const float filled : filled_) all += static_cast<double>(filled);
  std::vector<double> shares(rest_.size(), 0.0);
  for (std::size_t c = 0; c < corners_.size(); ++c)
    for (const std::uint32_t node : corners_[c]) shares[node] += static_cast<double>(filled_[c]) / (8 * all);
  return shares;
}

EmbeddedPlace SoftLattice::embed(const DVec3& place_m) const {
  // Half-open cells would assign the upper faces of a body to empty cells: the nearest cell is used instead.
  const DVec3 along = (place_m - box_.corner) / box_.spacing_m;
  const IVec3 home(glm::floor(along));
  EmbeddedPlace found;
  double nearest = std::numeric_limits<double>::infinity();
  for (int far = 0; far <= kFarthestCell && nearest > far - 1; ++far)
    for (int z = -far; z <= far; ++z)
      for (int y = -far; y <= far; ++y)
        for (int x = -far; x <= far; ++x) {
          if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != far) continue;
          const IVec3 cell = home + IVec3(x, y, z);
          if (!box_.holds(cell) || cellAt_[box_.numberOf(cell)] == kNone) continue;
          const DVec3 share = along - DVec3(cell);
          const double away = glm::length(share - glm::clamp(share, DVec3(0), DVec3(1)));
          if (!(away < nearest)) continue;
          nearest = away;
          found = {.cell = cellAt_[box_.numberOf(cell)], .share = Vec3(share)};
        }
  PALPATE_CHECK(nearest < kFarthestCell);
  return found;
}

std::vector<SurfacePlace> boxSurface(const DVec3& low_m, const DVec3& size_m, double spacing_m, int perSpacing) {
  const IVec3 cells(glm::max(glm::round(size_m / spacing_m), DVec3(1)));
  std::vector<SurfacePlace> surface;
  for (int axis = 0; axis < 3; ++axis) {
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    for (int a = 0; a < perSpacing * cells[first]; ++a)
      for (int b = 0; b < perSpacing * cells[second]; ++b)
        for (const int side : {0, cells[axis]}) {
          DVec3 place;
          place[axis] = side;
          place[first] = (a + 0.5) / perSpacing;
          place[second] = (b + 0.5) / perSpacing;
          DVec3 normal(0);
          normal[axis] = side == 0 ? -1 : 1;
          surface.push_back({.rest = low_m + spacing_m * place, .normal = normal});
        }
  }
  return surface;
}

SoftSolid boxSolid(const DVec3& low_m, const DVec3& size_m, double spacing_m) {
  const DVec3 sides = glm::max(glm::round(size_m / spacing_m), DVec3(1));
  LatticeBox box = LatticeBox::about(low_m, low_m + sides * spacing_m, spacing_m);
  box.filled.assign(box.filled.size(), 1);
  return {.lattice = SoftLattice(box), .surface = boxSurface(low_m, size_m, spacing_m, kPlacesOfSpacing)};
}

std::vector<SurfacePlace> ballSurface(const DVec3& middle_m, double radius_m, double spacing_m, int perSpacing) {
  // Points of equal area along a spiral by the golden angle (Vogel 1979).
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0)), apart_m = spacing_m / perSpacing;
  const auto count = static_cast<int>(std::ceil(4 * std::numbers::pi * radius_m * radius_m / (apart_m * apart_m)));
  std::vector<SurfacePlace> surface;
  for (int k = 0; k < count; ++k) {
    const double y = 1 - (2 * k + 1.0) / count, across = std::sqrt(1 - y * y);
    const DVec3 normal(across * std::cos(turn * k), y, across * std::sin(turn * k));
    surface.push_back({.rest = middle_m + radius_m * normal, .normal = normal});
  }
  return surface;
}

SoftSolid ballSolid(const DVec3& middle_m, double radius_m, double spacing_m) {
  LatticeBox box = LatticeBox::about(middle_m - radius_m, middle_m + radius_m, spacing_m);
  box.corner = middle_m - 0.5 * spacing_m * DVec3(box.cells);
  for (std::size_t c = 0; c < box.filled.size(); ++c) {
    const DVec3 low = box.corner + spacing_m * DVec3(box.cellOf(c)) - middle_m;
    int inside = 0;
    for (int k = 0; k < kBallSamples * kBallSamples * kBallSamples; ++k) {
      const DVec3 sample(k % kBallSamples + 0.5, k / kBallSamples % kBallSamples + 0.5,
                         k / kBallSamples / kBallSamples + 0.5);
      inside += glm::length(low + spacing_m / kBallSamples * sample) < radius_m ? 1 : 0;
    }
    box.filled[c] = static_cast<float>(inside) / (kBallSamples * kBallSamples * kBallSamples);
  }
  std::vector<SurfacePlace> surface = ballSurface(middle_m, radius_m, spacing_m, kPlacesOfSpacing);
  std::vector<std::size_t> kept;
  kept.reserve(surface.size());
  for (const SurfacePlace& place : surface)
    kept.push_back(box.numberOf(glm::clamp(box.cellAt(DVec3(place.rest)), IVec3(0), box.cells - 1)));
  return {.lattice = SoftLattice(std::move(box), kept), .surface = std::move(surface)};
}

}  // namespace palpate
