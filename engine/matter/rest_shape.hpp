// The shape in which a soft body rests: that of its lattice, and what sculpting has made of it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/matter/lanes.hpp"
#include "engine/matter/soft_lattice.hpp"
#include "shaders/shared/soft.h"

namespace palpate {

/// Where a node is to rest, m from its place in the lattice.
struct RestPlace {
  std::uint32_t node = 0;
  Vec3 moved{0};
};

/// Nodes rest where they were moved to; a cell whose nodes all rest in their places is a cube, and costs nothing
/// more. The lattice, the mass of each node and what a cell was filled with stay as they are, so that all that goes
/// by a node's share of a place - points, contact, presses - goes on as before.
class RestShape {
 public:
  using CellRestOfLanes = shared::CellRestOf<Lanes>;

  /// The lattice must outlive it.
  RestShape(const SoftLattice& lattice, const shared::SoftRules& rules);

  std::span<const Vec3> displacements() const { return moved_; }  ///< of each node from its place in the lattice, m
  bool isSculpted() const { return !ofCells_.empty(); }
  /// Null where it is a cube.
  const shared::CellRest* ofCell(std::size_t cell) const;
  /// Of so many cells as Lanes have; null where all of them are cubes.
  const CellRestOfLanes* ofGroup(std::size_t group) const;
  /// The deformation gradient of a cell over its rest shape, from the modes of its nodes' displacements.
  glm::mat3 elastic(std::size_t cell, const shared::Corners& modes) const;
  /// How many times the stiffest cell is as stiff for its mass as a cube.
  double stiffest() const { return stiffest_; }

  /// Moves nodes. Those of `places` whose cells would be crushed, stretched or turned inside out beyond what the body
  /// can be simulated with stay where they are, to the bit; how many have moved.
  std::size_t yield(std::span<const RestPlace> places);
  /// Moves nodes whatever comes of it: to where they were before.
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
  std::vector<shared::CellRest> ofCells_;  // of each cell; empty while all are cubes
  std::vector<float> stiffnesses_;         // of each cell; 0 where it is a cube
  std::vector<CellRestOfLanes> ofGroups_;  // of each group of cells
  std::vector<char> groupIsSculpted_;
  double stiffest_ = 1;
};

}  // namespace palpate
