// Memory layout of the cells, nodes and skin of a soft body on a GPU (shaders/shared/soft_passes.h).
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

  std::uint32_t skinCount = 0;   ///< number of cells with skin positions; in the first slots
  std::uint32_t firstInner = 0;  ///< slot of the first cell without skin, at the beginning of a block
  std::uint32_t slots = 0;
  std::uint32_t stride = 0;  ///< stride of planes, in floats
  float beyond = 0;          ///< shared::SoftSetting::beyond

  std::vector<std::uint32_t> slotOf;  ///< slot of each cell of the lattice
  std::vector<Four> corners;          ///< per slot
  std::vector<float> volumes;         ///< per slot, and for the slot of the empty cell, m^3
  std::vector<Four> incident;         ///< per node
  std::vector<shared::SoftSkinCell> skinCells;
  std::vector<Vec4> skin;         ///< by cell, in the order of the cells
  std::vector<Vec4> skinNormals;  ///< likewise: normal at rest, and the bits of the position's original number
  std::uint32_t skinNodes = 0;    ///< number of nodes with a share in a skin position

 private:
  void placeCells(const SoftLattice& lattice, std::span<const SkinPlace> places);
  void placeSkin(const SoftLattice& lattice, std::span<const SkinPlace> places);
};

}  // namespace palpate
