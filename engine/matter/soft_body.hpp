// The motion of a soft body: the forces of the cells on their nodes, and the motion of the nodes.
#pragma once

#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/lanes.hpp"
#include "engine/matter/rest_shape.hpp"
#include "engine/matter/soft_lattice.hpp"
#include "shaders/shared/soft.h"

namespace palpate {

/// The constants of shaders/shared/soft.h, derived from a material, and the longest stable substep.
struct SoftMaterial {
  double young_Pa = 0;        ///< Young's modulus
  double poisson = 0;         ///< Poisson's ratio, from 0 to below 0.5
  double density_kg_m3 = 0;   ///< kg/m^3
  double viscosity_Pa_s = 0;  ///< of a Kelvin-Voigt solid: stress of the strain plus twice this times the strain rate

  double shear_Pa() const { return young_Pa / (2 * (1 + poisson)); }
  double bulk_Pa() const { return young_Pa / (3 * (1 - 2 * poisson)); }
};

shared::SoftRules softRules(const SoftMaterial& material, double spacing_m);

/// Highest angular frequency of a single cell, for any fill, rad/s: it bounds that of any body.
double highestFrequency(const SoftMaterial& material, double spacing_m);

/// Frequency of the skin's contact springs for the mass that they press on: so stiff that they yield less than a
/// hundredth of a spacing under bearable loads, independently of the substeps, rad/s.
double touchFrequency(const SoftMaterial& material, double spacing_m);
/// Damping of a contact, in units of its stiffness over its frequency.
inline constexpr double kTouchDamping = 0.2;

/// Longest stable substep, s. `touched_kg_per_kg`: maximum mass of nodes that a tool presses on at a time, relative to
/// the tool's mass. `stiffer`: stiffness per mass of the stiffest cell, relative to a cube at rest.
double longestSubstep(const SoftMaterial& material, double spacing_m, double touched_kg_per_kg, double stiffer = 1);

/// An axis-aligned box, m.
struct PlaceBox {
  DVec3 low{0}, high{0};

  bool holds(const DVec3& place) const {
    return glm::all(glm::lessThanEqual(low, place)) && glm::all(glm::lessThanEqual(place, high));
  }
};

/// Mass of each node of a body with the given total mass, kg.
std::vector<float> nodeMasses(const SoftLattice& lattice, double mass_kg);
/// For each node whether its rest position is within one of the boxes.
std::vector<char> nodesWithin(const SoftLattice& lattice, std::span<const PlaceBox> boxes);

/// Sums over a body in a substep.
struct SoftSums {
  DVec3 momentum{0};  ///< kg m/s
  double kinetic_J = 0;
  DVec3 gravityImpulse{0};  ///< on the free nodes, kg m/s
  DVec3 pinImpulse{0};      ///< of the body on the supports of its pinned nodes, kg m/s
  float leastVolume = 1;    ///< minimum over all cells of the volume relative to that at rest
};

/// Each array has one entry per node. All passes are gathers: bitwise identical for any number of threads.
class SoftBody {
 public:
  /// The lattice must outlive the body. Nodes that rest within a box of `pinned` never move.
  SoftBody(const SoftLattice& lattice, const SoftMaterial& material, std::span<const PlaceBox> pinned);

  /// Sets another material; the masses stay.
  void setMaterial(const SoftMaterial& material) { rules_ = softRules(material, lattice_.spacing_m()); }

  const SoftLattice& lattice() const { return lattice_; }
  std::size_t size() const { return moved_.size(); }
  /// Moves every node to its rest position.
  void reset();

  /// The rest shape, which a brush changes.
  const RestShape& rest() const { return rest_; }
  /// Moves the rest positions of nodes, as RestShape::yield() does, and the nodes themselves by the corresponding
  /// displacements in the strained body: strains are kept, and unstrained parts stay at rest. `ways`: displacements of
  /// nodes that are not pinned, at their present positions, m. Returns the number of moved nodes.
  std::size_t yield(std::span<const RestPlace> ways);
  /// The same, back to earlier rest positions, without the limits of yield().
  void putRest(std::span<const RestPlace> places);

  std::span<const Vec3> displacements() const { return moved_; }  ///< from the lattice, m
  std::span<const Vec3> velocities() const { return velocities_; }
  /// For initial or changed motion; those of pinned nodes must stay 0.
  std::span<Vec3> displacements() { return moved_; }
  std::span<Vec3> velocities() { return velocities_; }
  /// As SoftLattice::incident().
  std::span<const SoftLattice::Corners> incident() const { return incident_; }
  /// Mass of each node, kg.
  std::span<const float> masses() const { return masses_; }
  bool isPinned(std::size_t node) const { return pinned_[node] != 0; }
  double mass_kg() const { return mass_kg_; }

  /// External forces on each node in the next substep, which clears them, N.
  std::span<Vec3> loads() { return loads_; }
  /// Symplectic Euler: strain() and move().
  SoftSums substep(const DVec3& gravity_m_s2, double step_s, WorkerTeam& team);
  /// Computes the forces of the cells on the nodes at their positions. Loads may depend on them.
  void strain(WorkerTeam& team);
  /// Moves the nodes by the forces of strain() and the loads.
  SoftSums move(const DVec3& gravity_m_s2, double step_s, WorkerTeam& team);
  /// Sum of the forces of strain() and the loads on a node, N.
  Vec3 forceOn(std::size_t node) const { return ofCells(node) + loads_[node]; }

  /// Forces of the cells on each node at its present position, N.
  std::vector<DVec3> forces(WorkerTeam& team);
  /// Decrease of those forces by small changes of the displacements (one per node, m), N: the stiffness of the body in
  /// its present strain times the changes. Changes of pinned nodes are taken as 0, and so are the results.
  void stiffnessTimes(std::span<const DVec3> changes, std::vector<DVec3>& forces, WorkerTeam& team);
  /// Strain energy relative to rest, J.
  double strainEnergy_J() const;
  /// Deformation gradients over the lattice, minus the identity: means of the cells around a node, weighted by their
  /// fill. Exact for a rotation and a stretch. `gradients`: one per node.
  void gradients(std::vector<glm::mat3>& gradients, WorkerTeam& team) const;
  /// The same for one cell.
  glm::mat3 gradientOf(std::size_t cell) const;

 private:
  using LanesOfCorners = shared::CornersOf<Lanes>;

  void pushCells(std::size_t block);
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
  std::vector<Vec3> moved_, velocities_, loads_;
  std::vector<Lanes> filled_;                 // per group of Lanes::kCount cells
  std::vector<LanesOfCorners> cornerForces_;  // per group, and for one more, empty cell
  std::vector<float> leastVolumes_;           // per block of cells
  std::vector<SoftSums> sums_;                // per block of nodes
};

}  // namespace palpate
