// Hands that press on the surface of a soft body, within its substeps.
#pragma once

#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/soft_body.hpp"
#include "engine/matter/surface_press.hpp"

namespace palpate {

/// The present surface of a soft body.
/// Evenly distributed surface positions, about half a cell spacing apart. For any thread while the body does not move.
class SoftSurface {
 public:
  SoftSurface(const SoftLattice& lattice, std::span<const SurfacePlace> surface);

  std::size_t size() const { return rest_.size(); }
  /// Present position, m; its normal, unit, outward.
  Vec3 placeOf(const SoftBody& body, std::size_t i) const;
  Vec3 normalOf(const SoftBody& body, std::size_t i) const;
  /// The surface position nearest to a position, m.
  std::uint32_t nearest(const SoftBody& body, const DVec3& place_m) const;
  /// Present positions of all of them, m.
  void places(const SoftBody& body, std::vector<Vec3>& now, WorkerTeam& team) const;
  /// Nodal forces, N, of a force of 1 N along `direction` distributed evenly over the surface positions within
  /// `radius_m` of a present position, or applied to the nearest one.
  std::vector<DVec3> spread(const SoftBody& body, const DVec3& place_m, double radius_m, const DVec3& direction) const;
  /// Calls visit(node, share) for the corners of a position's cell, with their shares of it.
  template <class Visit>
  void forEachNode(const SoftBody& body, std::size_t i, Visit&& visit) const {
    const SoftLattice::Corners& nodes = body.lattice().corners()[embedded_[i].cell];
    for (int k = 0; k < 8; ++k) visit(nodes[static_cast<std::size_t>(k)], shared::cornerShare(embedded_[i].share, k));
  }

 private:
  std::vector<SurfacePlace> rest_;  // in the lattice
  std::vector<EmbeddedPlace> embedded_;
};

/// The surface position of a press is the mean of the positions around it, with the weights of touch (Wendland's,
/// reduced for those that face away from the press, so that only the touched side of a sheet is pressed). The force is
/// distributed to the nodes by the same shares, so the work of the hand on that position is exactly the work on the
/// body. Spring and damper are solved implicitly together with the actions of the cells and the other presses in the
/// same substep, one press after another from their previous values (Gauss-Seidel), so they are stable for arbitrarily
/// light nodes and stiff hands. Forces never pull.
class SoftPress {
 public:
  /// `surface`: surface that may be pressed; must outlive this.
  SoftPress(const SoftBody& body, const SoftSurface& surface);

  /// Sets the presses for a step of length `duration_s`.
  void begin(const SoftBody& body, std::span<const SurfacePress> presses, double duration_s, WorkerTeam& team);
  /// Adds the presses' forces to the body's loads for a substep, at whose end `share` of the step is over; call after
  /// all other loads and strain().
  void load(SoftBody& body, double share, double substep_s, const DVec3& gravity_m_s2);
  /// Ends the step; each press has its report.
  void end(const SoftBody& body);

  std::span<const PressReport> reports() const { return reports_; }

 private:
  struct Held {
    std::uint32_t node;
    float share;
    Vec3 began;  // displacement of the node when the step began, m
  };
  // A press with its nodes, which are contiguous in held_.
  struct Hold {
    SurfacePress press;
    std::size_t first = 0, last = 0;
    double perMass = 0;    // acceleration of the position per force on it, 1/kg
    DVec3 hand{0};         // hand position at the end of the last substep, m
    DVec3 force{0};        // force on the hand in this substep, N
    bool isAlone = false;  // PressReport::isAlone
  };
  void hold(const SoftBody& body, Hold& hold);
  // Keeps the nodes of the previous step.
  void holdOn(const SoftBody& body, Hold& hold, const Hold& before, std::span<const Held> heldBefore);
  DVec3 movedBy(const SoftBody& body, const Hold& hold) const;
  struct Substep {
    double share, length_s;
    DVec3 gravity;
  };
  // Velocity of the position at the end of the substep, with all present loads.
  DVec3 velocityAfter(const SoftBody& body, const Hold& hold, const Substep& substep) const;
  DVec3 forceOnHand(const SoftBody& body, const Hold& hold, const Substep& substep) const;
  void loadMore(SoftBody& body, const Hold& hold, const DVec3& onHand) const;
  void limit(SoftBody& body);

  const SoftSurface& surface_;
  std::vector<Vec3> now_;      // surface positions, m
  std::vector<float> shares_;  // per node; all 0 between two calls of hold()
  std::vector<Hold> holds_;
  std::vector<Held> held_;
  std::vector<PressReport> reports_;
  double duration_s_ = 0;
};

}  // namespace palpate
