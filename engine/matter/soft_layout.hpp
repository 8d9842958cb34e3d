// How the cells, nodes and the skin of a soft body stand in a GPU's memory (shaders/shared/soft_passes.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/matter/soft_contact.hpp"
#include "engine/matter/soft_lattice.hpp"
#include "shaders/shared/soft_passes.h"

namespace palpate {

struct SoftLayout {
  using Four = glm::uvec4;

  /// `skin`: in any order.
  SoftLayout(const SoftLattice& lattice, std::span<const SkinPlace> skin);

  std::uint32_t skinCount = 0;   ///< cells with a place of the skin, in the first slots
  std::uint32_t firstInner = 0;  ///< slot of the first cell without one, where a block begins
  std::uint32_t slots = 0;
  std::uint32_t stride = 0;  ///< of planes, floats
  float beyond = 0;          ///< shared::SoftSetting::beyond

  std::vector<std::uint32_t> slotOf;  ///< of each cell of the lattice
  std::vector<Four> corners;          ///< of each slot
  std::vector<float> volumes;         ///< of each slot and the one that is no cell, m^3
  std::vector<Four> incident;         ///< of each node
  std::vector<shared::SoftSkinCell> skinCells;
  std::vector<Vec4> skin;         ///< cell by cell, in their order
  std::vector<Vec4> skinNormals;  ///< likewise: at rest, and the bits of their numbers as they were given
  std::uint32_t skinNodes = 0;    ///< nodes that have a part in a place of the skin

 private:
  void placeCells(const SoftLattice& lattice, std::span<const SkinPlace> places);
  void placeSkin(const SoftLattice& lattice, std::span<const SkinPlace> places);
};

}  // namespace palpate
