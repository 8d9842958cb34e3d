// Hands that press on the surface of a soft body, within its substeps.
#pragma once

#include <span>
#include <vector>

#include "engine/matter/soft_surface.hpp"
#include "engine/matter/surface_press.hpp"

namespace palpate {

/// Where a press has its place, the surface is the mean of what lies about it, with the weights that touch has for it
/// (Wendland's, and less for what faces away from the press, so that of a sheet only the side is pressed that is
/// touched), and the force goes to the nodes by the same shares: what the hand does to the place is what it does to
/// the body, to the last bit of work. Spring and damper are solved implicitly for what the cells and the other
/// presses do to the place in the same substep, one press after another from what they were before (Gauss and
/// Seidel), so that they are stable however light the nodes are and however stiff a hand is. Nothing pulls.
class SoftPress {
 public:
  /// `surface`: where a body may be pressed; outlives this.
  SoftPress(const SoftBody& body, const SoftSurface& surface);

  /// From now on these press, for a step of that length.
  void begin(const SoftBody& body, std::span<const SurfacePress> presses, double duration_s, WorkerTeam& team);
  /// Loads the body for a substep, at whose end `share` of the step is over; behind all other loads, and what the
  /// cells do.
  void load(SoftBody& body, double share, double substep_s, const DVec3& gravity_m_s2);
  /// The step is over; each press has its report.
  void end(const SoftBody& body);

  std::span<const PressReport> reports() const { return reports_; }

 private:
  struct Held {
    std::uint32_t node;
    float share;
    Vec3 began;  // displacement of the node when the step began, m
  };
  // A press with its nodes, which stand in held_ one behind another.
  struct Hold {
    SurfacePress press;
    std::size_t first = 0, last = 0;
    double perMass = 0;    // acceleration of the place for a force on it, 1/kg
    DVec3 hand{0};         // where it was at the end of the last substep, m
    DVec3 force{0};        // of this substep, on the hand, N
    bool isAlone = false;  // PressReport::isAlone
  };
  void hold(const SoftBody& body, Hold& hold);
  // The same nodes as in the step before.
  void holdOn(const SoftBody& body, Hold& hold, const Hold& before, std::span<const Held> heldBefore);
  DVec3 movedBy(const SoftBody& body, const Hold& hold) const;
  struct Substep {
    double share, length_s;
    DVec3 gravity;
  };
  // Of the place at the end of the substep, with all loads there are.
  DVec3 velocityAfter(const SoftBody& body, const Hold& hold, const Substep& substep) const;
  DVec3 forceOnHand(const SoftBody& body, const Hold& hold, const Substep& substep) const;
  void loadMore(SoftBody& body, const Hold& hold, const DVec3& onHand) const;
  void limit(SoftBody& body);

  const SoftSurface& surface_;
  std::vector<Vec3> now_;      // where the places of the surface are, m
  std::vector<float> shares_;  // of each node, all 0 between two holds
  std::vector<Hold> holds_;
  std::vector<Held> held_;
  std::vector<PressReport> reports_;
  double duration_s_ = 0;
};

}  // namespace palpate
