// Shape matching: pulls a body's nodes back to its shape by geometry alone, without a material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

struct MatchingRules {
  double stiffness_1_s2 = 0;  ///< pull towards the matched position, per kg and m
  double damping_1_s = 0;     ///< damping of motion relative to the rigid motion of the region, per kg and m/s
  double energy_1_s2 = 0;     ///< of the energy whose gradient is that pull at the end of the substep, per kg and m

  /// For correcting a share of the displacement in each substep, above 0 and below 1. Displacement and velocity are
  /// corrected alike: this is implicit Euler for a spring, which is stable at any substep and gains no energy.
  static MatchingRules inSubstep(double stiffness, double substep_s);
};

/// Regions of four nodes along each axis, each sharing two with the next, so that a body bends. The rest shape of each
/// region is rotated and translated to fit best to its nodes' present positions (Mueller, Heidelberger, Teschner, Gross
/// 2005, "Meshless deformations based on shape matching"); a node is pulled to its position in the fitted regions, by
/// shares of its mass, so that no region adds momentum or angular momentum. The rotation is the global optimum (Horn
/// 1987) for every region, even flat or inverted, and is tracked from substep to substep if possible. It is not
/// calibrated: the stiffness of a body depends on its lattice and substep.
class ShapeMatching {
 public:
  /// `masses`: of the nodes, kg.
  ShapeMatching(const SoftLattice& lattice, std::span<const float> masses, const MatchingRules& rules);

  /// Sets other rules.
  void setRules(const MatchingRules& rules) { rules_ = rules; }
  /// Resets all rotations.
  void begin();
  /// Sets the rest displacements of the nodes from the lattice, m.
  void setRest(std::span<const Vec3> displacements);
  /// Computes the forces of the regions on the nodes; displacements are from the lattice, m. Identical for any number
  /// of threads.
  void push(std::span<const Vec3> displacements, std::span<const Vec3> velocities, WorkerTeam& team);
  std::span<const Vec3> forces() const { return forces_; }  ///< per node, of the last push(), N
  /// Energy for these displacements of the nodes from the lattice, J.
  double energy_J(std::span<const Vec3> displacements) const;

  std::size_t regions() const { return regions_.size(); }
  /// Last rotation of each region, from which the next push() continues.
  std::vector<DQuat> turns() const;
  void setTurns(std::span<const DQuat> turns);

 private:
  struct Region {
    std::uint32_t first = 0, last = 0;  // range of its members
    DVec3 atRest{0};                    // its centroid at rest, m
    DQuat turn{1, 0, 0, 0};
    DVec3 middle{0}, velocity{0}, spin{0};  // present values, m, m/s, rad/s
    glm::dmat3 rotation{1};
  };
  struct Member {
    std::uint32_t node = 0;
    double mass = 0;  // its share of the node's mass
    DVec3 arm{0};     // from the region's centroid, at rest, m
  };
  void place(Region& region, std::span<const Vec3> displacements) const;
  void follow(Region& region, std::span<const Vec3> displacements, std::span<const Vec3> velocities) const;
  DVec3 placeOf(const Member& member, std::span<const Vec3> displacements) const;
  DVec3 goalOf(const Region& region, const Member& member) const {
    return region.middle + region.rotation * member.arm;
  }

  std::span<const Vec3> lattice_;
  MatchingRules rules_;
  std::vector<Region> regions_;
  std::vector<Member> members_;  // sorted by region
  struct Part {
    std::uint32_t region = 0, member = 0;
  };
  std::vector<std::uint32_t> firstPart_;  // first part of each node, and the end
  std::vector<Part> parts_;               // membership of a node in a region
  std::vector<Vec3> forces_;
};

}  // namespace palpate
