// Shape matching: what pulls a body's nodes back to its shape by geometry alone, without a material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

struct MatchingRules {
  double stiffness_1_s2 = 0;  ///< pull towards the matched place, for each kg and m
  double damping_1_s = 0;     ///< of what moves otherwise than its region does as a whole, for each kg and m/s
  double energy_1_s2 = 0;     ///< of the energy whose slope that pull is at the end of the substep, for each kg and m

  /// Of a share of the way back in each substep, above 0 and below 1. Way and motion count alike: so implicit Euler
  /// goes for a spring, which is stable whatever the substep is, and gains no energy.
  static MatchingRules inSubstep(double stiffness, double substep_s);
};

/// Regions of four nodes along each axis, of which each shares two with the next one, so that a body bends. Each is
/// put as it is at rest, turned and moved to where it lies best on where its nodes now are (Mueller, Heidelberger,
/// Teschner, Gross 2005, "Meshless deformations based on shape matching"); a node is pulled to where its regions
/// would have it, by shares of its mass, so that no region gets momentum or a turn from itself. The rotation is the
/// best there is (Horn 1987) for every region, flat or inside out, and followed from substep to substep where it can
/// be. It is not calibrated: how stiff a body is depends on its lattice and substep.
class ShapeMatching {
 public:
  /// `masses`: of the nodes, kg.
  ShapeMatching(const SoftLattice& lattice, std::span<const float> masses, const MatchingRules& rules);

  /// From now on other ones.
  void setRules(const MatchingRules& rules) { rules_ = rules; }
  /// Nothing is turned.
  void begin();
  /// Nodes rest so far from their places in the lattice, m.
  void setRest(std::span<const Vec3> displacements);
  /// Finds what the regions do to the nodes; displacements are from the lattice, m. The same for any number of threads.
  void push(std::span<const Vec3> displacements, std::span<const Vec3> velocities, WorkerTeam& team);
  std::span<const Vec3> forces() const { return forces_; }  ///< of each node, as push() has found them, N
  /// Of nodes that are so far from their places in the lattice, J.
  double energy_J(std::span<const Vec3> displacements) const;

  std::size_t regions() const { return regions_.size(); }
  /// How each region was turned last, from where the next push() goes on.
  std::vector<DQuat> turns() const;
  void setTurns(std::span<const DQuat> turns);

 private:
  struct Region {
    std::uint32_t first = 0, last = 0;  // of its members
    DVec3 atRest{0};                    // its middle, m
    DQuat turn{1, 0, 0, 0};
    DVec3 middle{0}, velocity{0}, spin{0};  // now, m, m/s, rad/s
    glm::dmat3 rotation{1};
  };
  struct Member {
    std::uint32_t node = 0;
    double mass = 0;  // its share of the node's
    DVec3 arm{0};     // from the region's middle, at rest, m
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
  std::vector<Member> members_;  // region by region
  struct Part {
    std::uint32_t region = 0, member = 0;
  };
  std::vector<std::uint32_t> firstPart_;  // of each node, and the end
  std::vector<Part> parts_;               // that a node has of regions
  std::vector<Vec3> forces_;
};

}  // namespace palpate
