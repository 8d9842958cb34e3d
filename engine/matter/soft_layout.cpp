#include "engine/matter/soft_layout.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kStrideUnit = 32;  // planes are aligned to cache lines

std::uint32_t roundedUp(std::size_t count, std::uint32_t unit) {
  return static_cast<std::uint32_t>((count + unit - 1) / unit * unit);
}

// Bound of how far a skin position can be outside the box of its cell's corners, relative to the extent of that box:
// shares outside 0 to 1 extrapolate along each axis, by at most `most`.
float beyondOf(std::span<const SkinPlace> places) {
  float most = 0;
  for (const SkinPlace& place : places)
    for (int axis = 0; axis < 3; ++axis) most = std::max({most, -place.at.share[axis], place.at.share[axis] - 1});
  return (std::pow(1 + 2 * most, 3.0f) - 1) / 2 + 1e-6f;
}

}  // namespace

SoftLayout::SoftLayout(const SoftLattice& lattice, std::span<const SkinPlace> places) : beyond(beyondOf(places)) {
  placeCells(lattice, places);
  placeSkin(lattice, places);
}

void SoftLayout::placeCells(const SoftLattice& lattice, std::span<const SkinPlace> places) {
  std::vector<char> hasSkin(lattice.cells(), 0);
  for (const SkinPlace& place : places) hasSkin[place.at.cell] = 1;
  skinCount = static_cast<std::uint32_t>(std::ranges::count(hasSkin, 1));
  firstInner = roundedUp(skinCount, shared::kMatterBlock);
  slots = firstInner + static_cast<std::uint32_t>(lattice.cells()) - skinCount;
  stride = roundedUp(std::size_t{slots} + 1, kStrideUnit);
  corners.resize(slots);
  volumes.assign(std::size_t{slots} + 1, 0);
  const double cube = std::pow(lattice.spacing_m(), 3);
  std::uint32_t nextSkin = 0, nextInner = firstInner;
  for (std::size_t c = 0; c < lattice.cells(); ++c) {
    const std::uint32_t slot = slotOf.emplace_back(hasSkin[c] != 0 ? nextSkin++ : nextInner++);
    const SoftLattice::Corners& nodes = lattice.corners()[c];
    for (std::size_t k = 0; k < 8; k += 2) PALPATE_CHECK_EQ(nodes[k] + 1, nodes[k + 1]);
    corners[slot] = {nodes[0], nodes[2], nodes[4], nodes[6]};
    volumes[slot] = static_cast<float>(cube * static_cast<double>(lattice.filled()[c]));
  }
  for (const SoftLattice::Corners& about : lattice.incident()) {
    bool isSkin = false;
    for (std::size_t k = 0; k < 8; ++k) {
      if (k % 4 == 0) incident.emplace_back(0);
      const std::size_t cell = about[k] / 8;
      const std::uint32_t slot = cell == lattice.cells() ? slots : slotOf[cell], corner = about[k] % 8;
      incident.back()[static_cast<int>(k % 4)] = 3 * corner * stride + slot;
      isSkin |= slot < skinCount;
    }
    skinNodes += isSkin ? 1 : 0;
  }
}

void SoftLayout::placeSkin(const SoftLattice& lattice, std::span<const SkinPlace> places) {
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return slotOf[places[i].at.cell]; });
  skinCells.resize(std::size_t{skinCount} + 1);
  for (std::size_t c = 0; c < lattice.cells(); ++c)
    if (slotOf[c] < skinCount) skinCells[slotOf[c]].corner = lattice.rest()[lattice.corners()[c][0]];
  std::uint32_t next = 0;
  for (std::size_t k = 0; k < skinCells.size(); ++k) {
    skinCells[k].first = next;
    for (; next < order.size() && slotOf[places[order[next]].at.cell] == k; ++next) {
      const SkinPlace& place = places[order[next]];
      skinNormals.emplace_back(place.normal, std::bit_cast<float>(static_cast<std::uint32_t>(order[next])));
      skin.emplace_back(place.at.share, place.stiffness);
      skin.emplace_back(place.rest, 0);
    }
  }
}

}  // namespace palpate
