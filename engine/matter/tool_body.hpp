// A ball between a hand and matter: a simulated body, coupled to the hand by a spring and a damper (virtual coupling;
// Colgate, Stanley, Brown 1995), so that the hand's force is limited by the spring.
#pragma once

#include "engine/matter/boundary.hpp"
#include "engine/matter/hand_pose.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/matter_simulation.hpp"

namespace palpate {

/// Spring and damper of a tool's ball: soft enough for a loop at 1 kHz, stiff enough to follow a hand.
shared::ToolSpringOf<double> toolSpring(const MatterTool& tool, double step_s);

/// Stiffness of that spring as felt by the hand, times the scene's gain, N/m.
double couplingStiffness_N_m(const MatterScene& scene);

/// Has no weight: the hand feels the buoyancy of a ball in water. Its orientation is the hand's.
class ToolBody {
 public:
  explicit ToolBody(const shared::ToolSpringOf<double>& spring) : spring_(spring) {}

  /// Sets the spring for another substep.
  void setSpring(const shared::ToolSpringOf<double>& spring) { spring_ = spring; }
  /// Places the ball at the hand, at rest.
  void placeAt(const HandPose& hand);
  /// A substep without matter, coupled to a hand that moves to `hand` meanwhile.
  void predict(const HandPose& hand);
  /// Moves the ball, with this radius, out of a static model.
  void stopAt(const MatterModel& model, double radius_m);
  /// Applies the action of the matter in this substep.
  void react(const Exchange& exchange);

  const BodyMotion& motion() const { return motion_; }
  /// The report since the last call.
  ToolReport takeReport();

 private:
  shared::ToolSpringOf<double> spring_;
  HandPose hand_;
  BodyMotion motion_;
  ToolReport report_;
};

}  // namespace palpate
