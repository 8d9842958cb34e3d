#include "engine/matter/tool_body.hpp"

#include <numbers>
#include <utility>

namespace palpate {

namespace {

// Natural frequency of the ball on its spring, critically damped.
constexpr double kCouplingFrequency_Hz = 30;

}  // namespace

shared::ToolSpringOf<double> toolSpring(const MatterTool& tool, double step_s) {
  const double angular = 2 * std::numbers::pi * kCouplingFrequency_Hz;
  return {.mass = tool.mass_kg,
          .stiffness = tool.mass_kg * angular * angular,
          .damping = 2 * tool.mass_kg * angular,
          .step = step_s};
}

double couplingStiffness_N_m(const MatterScene& scene) {
  return scene.gain * toolSpring(scene.tool, kMatterStep_s).stiffness;
}

void ToolBody::placeAt(const HandPose& hand) {
  hand_ = hand;
  motion_ = {.place = hand.place_m, .orientation = hand.orientation};
  report_ = {};
}

void ToolBody::predict(const HandPose& hand) {
  const DVec3 handMove = hand.place_m - hand_.place_m;
  const DVec3 before = motion_.velocity;
  motion_.velocity = shared::velocityOnSpring<double>(spring_, before, hand.place_m - motion_.place, handMove);
  motion_.place += spring_.step * motion_.velocity;
  motion_.spin = spinBetween(motion_.orientation, hand.orientation, spring_.step);
  motion_.orientation = hand.orientation;
  const DVec3 impulse = spring_.mass * (motion_.velocity - before);
  report_.springImpulse += impulse;
  report_.portWork_J += glm::dot(impulse / spring_.step, handMove);
  hand_ = hand;
}

void ToolBody::stopAt(const MatterModel& model, double radius_m) {
  const shared::StoppedBall stopped =
      shared::stoppedBall(model.at(Vec3(motion_.place)), static_cast<float>(radius_m), Vec3(motion_.velocity));
  motion_.place += DVec3(stopped.move);
  motion_.velocity += DVec3(stopped.change);
  report_.modelImpulse += spring_.mass * DVec3(stopped.change);
}

void ToolBody::react(const Exchange& exchange) {
  const DVec3 change = exchange.impulse / spring_.mass;
  motion_.velocity += change;
  motion_.place += spring_.step * change;
  report_.impulse += exchange.impulse;
  report_.angular += exchange.angular;
}

ToolReport ToolBody::takeReport() {
  report_.place_m = motion_.place;
  report_.velocity_m_s = motion_.velocity;
  return std::exchange(report_, {});
}

}  // namespace palpate
