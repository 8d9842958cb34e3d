// A ball between a hand and matter: a simulated body, tied to the hand by a spring and a damper (virtual coupling;
// Colgate, Stanley, Brown 1995), so that what the hand feels is bounded by what the spring holds.
#pragma once

#include "engine/matter/boundary.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// Where a hand is.
struct HandPose {
  DVec3 place_m{0};
  DQuat orientation{1, 0, 0, 0};
};

/// Where a hand is that goes from one pose to another, after a share of the way.
HandPose between(const HandPose& from, const HandPose& to, double share);

/// What a hand is answered, means over a step. Zero where the simulation has failed.
struct ToolAnswer {
  DVec3 force_N{0};     ///< of the spring and damper on the hand, times the scene's gain
  DVec3 torque_Nm{0};   ///< of the matter on the ball about its middle, times the gain
  DVec3 reaction_N{0};  ///< of the matter on the ball: the sum of the impulses exchanged, over the step
  DVec3 place_m{0};     ///< of the ball at the end
};

/// Has no weight of its own: what a hand feels of a ball in water is its buoyancy. It turns as the hand does.
class ToolBody {
 public:
  ToolBody(const MatterTool& tool, double step_s);

  /// Where the hand is, and the ball, at rest.
  void placeAt(const HandPose& hand);
  /// A substep by itself, towards a hand that moves to `hand` meanwhile.
  void predict(const HandPose& hand);
  /// What the matter has done to it meanwhile.
  void react(const Exchange& exchange);

  const BodyMotion& motion() const { return motion_; }
  /// What was gathered since the last call, over `duration_s`; without the gain.
  ToolAnswer takeAnswer(double duration_s);
  /// Energy that the hand has put in through the spring and damper, J. Passive where it is never below 0.
  double portEnergy_J() const { return portEnergy_J_; }
  DVec3 momentum() const { return mass_kg_ * motion_.velocity; }
  /// On the ball from the hand since it was placed, kg m/s.
  const DVec3& handImpulse() const { return handImpulse_; }

 private:
  double mass_kg_, stiffness_N_m_, damping_Ns_m_, step_s_;
  HandPose hand_;
  BodyMotion motion_;
  DVec3 springImpulse_{0}, handImpulse_{0};
  Exchange exchanged_;
  double portEnergy_J_ = 0;
};

}  // namespace palpate
