// The rest shape of a soft body: its lattice as changed by sculpting.
#pragma once

#include <span>
#include <vector>

#include "engine/core/shape_strokes.hpp"
#include "engine/matter/lanes.hpp"
#include "engine/matter/soft_lattice.hpp"
#include "shaders/shared/soft.h"

namespace palpate {

/// Rest displacements of the nodes; a cell whose nodes are all undisplaced is a cube, without further cost. The
/// lattice, the nodes' masses and the cells' fills stay, so that everything based on a node's shares - points, contact,
/// presses - is unaffected.
class RestShape {
 public:
  using CellRestOfLanes = shared::CellRestOf<Lanes>;

  /// The lattice must outlive it.
  RestShape(const SoftLattice& lattice, const shared::SoftRules& rules);

  std::span<const Vec3> displacements() const { return moved_; }  ///< of each node from its lattice position, m
  bool isSculpted() const { return !ofCells_.empty(); }
  /// Null if it is a cube.
  const shared::CellRest* ofCell(std::size_t cell) const;
  /// For a group of Lanes::kCount cells; null if all are cubes.
  const CellRestOfLanes* ofGroup(std::size_t group) const;
  /// The deformation gradient of a cell over its rest shape, from the modes of its nodes' displacements.
  glm::mat3 elastic(std::size_t cell, const shared::Corners& modes) const;
  /// Stiffness per mass of the stiffest cell, relative to a cube.
  double stiffest() const { return stiffest_; }

  /// Moves rest positions. Nodes of `places` whose cells would be crushed, stretched or inverted beyond what can be
  /// simulated stay exactly where they are. Returns the number of moved nodes.
  std::size_t yield(std::span<const RestPlace> places);
  /// Moves rest positions without these limits: to earlier ones.
  void put(std::span<const RestPlace> places);

 private:
  struct CellNow {
    shared::CellRest rest;
    float stiffness = 1;
    bool isCube = true;
  };
  CellNow cellNow(std::size_t cell) const;
  bool holds(std::size_t cell) const;
  void follow(std::span<const RestPlace> places);

  const SoftLattice& lattice_;
  shared::SoftRules rules_;
  std::vector<SoftLattice::Corners> incident_;
  std::vector<Vec3> moved_;
  std::vector<shared::CellRest> ofCells_;  // per cell; empty while all are cubes
  std::vector<float> stiffnesses_;         // per cell; 0 for a cube
  std::vector<CellRestOfLanes> ofGroups_;  // per group of cells
  std::vector<char> groupIsSculpted_;
  double stiffest_ = 1;
};

}  // namespace palpate
