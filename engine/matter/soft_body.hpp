// The motion of a soft body: what cells do to their nodes, and where the nodes go.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/lanes.hpp"
#include "engine/matter/rest_shape.hpp"
#include "engine/matter/shape_matching.hpp"
#include "engine/matter/soft_lattice.hpp"
#include "engine/matter/soft_rules.hpp"

namespace palpate {

/// A box of places, m.
struct PlaceBox {
  DVec3 low{0}, high{0};

  bool holds(const DVec3& place) const {
    return glm::all(glm::lessThanEqual(low, place)) && glm::all(glm::lessThanEqual(place, high));
  }
};

/// Mass of each node of a body that weighs so much, kg.
std::vector<float> nodeMasses(const SoftLattice& lattice, double mass_kg);
/// Of each node whether it is at rest within one of the boxes.
std::vector<char> nodesWithin(const SoftLattice& lattice, std::span<const PlaceBox> boxes);

/// What a body has come to in a substep.
struct SoftSums {
  DVec3 momentum{0};  ///< kg m/s
  double kinetic_J = 0;
  DVec3 gravityImpulse{0};  ///< on the nodes that are free, kg m/s
  DVec3 pinImpulse{0};      ///< of the body on what holds its pinned nodes, kg m/s
  float leastVolume = 1;    ///< of all cells: the least share of its volume that one has
};

/// Each array has one entry a node. All passes are gathers: the same bytes for any number of threads.
class SoftBody {
 public:
  /// The lattice must outlive the body. Nodes at rest within a box of `pinned` never move. `matching`: shapes are
  /// matched in place of elasticity, of which the material has the density alone then.
  SoftBody(const SoftLattice& lattice, const SoftMaterial& material, std::span<const PlaceBox> pinned,
           const std::optional<MatchingRules>& matching = std::nullopt);

  /// From now on another one; the masses stay, and so does what brings it back to its shape: `matching` is given where
  /// it is that.
  void setMaterial(const SoftMaterial& material, const std::optional<MatchingRules>& matching) {
    rules_ = softRules(material, lattice_.spacing_m());
    if (matching) matching_->setRules(*matching);
  }

  const SoftLattice& lattice() const { return lattice_; }
  std::size_t size() const { return moved_.size(); }
  /// Puts every node where it rests.
  void reset();

  /// The shape in which it rests, which a brush changes.
  const RestShape& rest() const { return rest_; }
  /// Moves where nodes rest, as RestShape::yield() does, and the nodes themselves by as much as those have moved in
  /// the strained body: what was strained stays as strained as it was, and what was not is at rest. `ways`: of nodes
  /// that are not pinned, as they now are, m. How many have moved.
  std::size_t yield(std::span<const RestPlace> ways);
  /// The same to where nodes rested before, whatever comes of it.
  void putRest(std::span<const RestPlace> places);

  std::span<const Vec3> displacements() const { return moved_; }  ///< from the lattice, m
  std::span<const Vec3> velocities() const { return velocities_; }
  /// For what begins or goes on with another motion; those of pinned nodes must stay 0.
  std::span<Vec3> displacements() { return moved_; }
  std::span<Vec3> velocities() { return velocities_; }
  /// SoftLattice's.
  std::span<const SoftLattice::Corners> incident() const { return incident_; }
  /// Mass of each node, kg.
  std::span<const float> masses() const { return masses_; }
  bool isPinned(std::size_t node) const { return pinned_[node] != 0; }
  double mass_kg() const { return mass_kg_; }

  /// What else acts on each node in the next substep, which forgets it, N.
  std::span<Vec3> loads() { return loads_; }
  /// Symplectic Euler: strain() and move().
  SoftSums substep(const DVec3& gravity_m_s2, double step_s, WorkerTeam& team);
  /// Finds what the cells do to the nodes as they are. Loads may depend on it.
  void strain(WorkerTeam& team);
  /// Moves the nodes on by what strain() has found and the loads.
  SoftSums move(const DVec3& gravity_m_s2, double step_s, WorkerTeam& team);
  /// What strain() has found and the loads do to a node, N.
  Vec3 forceOn(std::size_t node) const { return ofCells(node) + loads_[node]; }

  /// What the cells do to each node as it is, N.
  std::vector<DVec3> forces(WorkerTeam& team);
  /// What changes of the displacements (one a node, m) take away from those forces, as the body is now strained, N:
  /// those times its stiffness. Those of pinned nodes are taken for 0, and get none.
  void stiffnessTimes(std::span<const DVec3> changes, std::vector<DVec3>& forces, WorkerTeam& team);
  /// Of the strains, more than at rest, J.
  double strainEnergy_J() const;
  /// Deformation gradients over the lattice less 1: of the cells about a node, by what they hold. A rotation and a
  /// stretch are exact. `gradients`: one a node.
  void gradients(std::vector<glm::mat3>& gradients, WorkerTeam& team) const;
  /// The same of one cell.
  glm::mat3 gradientOf(std::size_t cell) const;

 private:
  using LanesOfCorners = shared::CornersOf<Lanes>;

  void pushCells(std::size_t block);
  void moveWithRest(std::span<const RestPlace> places, std::span<const Vec3> before);
  glm::mat3 elasticAt(std::size_t node) const;
  void moveNodes(std::size_t block, const Vec3& fall, float step_s, SoftSums& sums);
  Vec3 ofCells(std::size_t node) const;
  shared::Corners atCorners(std::size_t cell, std::span<const Vec3> values) const;
  LanesOfCorners atCornersOfGroup(std::size_t group, std::span<const Vec3> values) const;

  const SoftLattice& lattice_;
  shared::SoftRules rules_;
  double mass_kg_;
  std::vector<float> masses_;
  std::vector<char> pinned_;
  std::vector<SoftLattice::Corners> incident_;
  RestShape rest_;
  std::optional<ShapeMatching> matching_;  // in place of elasticity
  std::vector<Vec3> moved_, velocities_, loads_;
  std::vector<Lanes> filled_;                 // of each group of Lanes::kCount cells
  std::vector<LanesOfCorners> cornerForces_;  // of each group, and of one more cell, which is none
  std::vector<float> leastVolumes_;           // of each block of cells
  std::vector<SoftSums> sums_;                // of each block of nodes
};

}  // namespace palpate
