// A ball between a hand and matter: a simulated body, tied to the hand by a spring and a damper (virtual coupling;
// Colgate, Stanley, Brown 1995), so that what the hand feels is bounded by what the spring holds.
#pragma once

#include "engine/matter/boundary.hpp"
#include "engine/matter/hand_pose.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/matter_simulation.hpp"

namespace palpate {

/// What holds the ball of a tool: soft enough for a loop at 1 kHz, stiff enough to follow a hand.
shared::ToolSpringOf<double> toolSpring(const MatterTool& tool, double step_s);

/// Stiffness of that spring as the hand feels it, with the gain of the scene, N/m.
double couplingStiffness_N_m(const MatterScene& scene);

/// Has no weight of its own: what a hand feels of a ball in water is its buoyancy. It turns as the hand does.
class ToolBody {
 public:
  explicit ToolBody(const shared::ToolSpringOf<double>& spring) : spring_(spring) {}

  /// With another substep from now on.
  void setSpring(const shared::ToolSpringOf<double>& spring) { spring_ = spring; }
  /// Where the hand is, and the ball, at rest.
  void placeAt(const HandPose& hand);
  /// A substep by itself, towards a hand that moves to `hand` meanwhile.
  void predict(const HandPose& hand);
  /// Out of a model that stands still, as a ball of that radius.
  void stopAt(const MatterModel& model, double radius_m);
  /// What the matter has done to it meanwhile.
  void react(const Exchange& exchange);

  const BodyMotion& motion() const { return motion_; }
  /// What was gathered since the last call.
  ToolReport takeReport();

 private:
  shared::ToolSpringOf<double> spring_;
  HandPose hand_;
  BodyMotion motion_;
  ToolReport report_;
};

}  // namespace palpate
