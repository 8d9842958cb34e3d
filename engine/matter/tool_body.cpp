#include "engine/matter/tool_body.hpp"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace palpate {

namespace {

// Of the ball on its spring, critically damped: soft enough for a loop at 1 kHz, stiff enough to follow a hand.
constexpr double kCouplingFrequency_Hz = 30;
constexpr double kPi = 3.14159265358979323846;

// Angular velocity that turns `from` into `to` within `step_s`, rad/s.
DVec3 spinBetween(const DQuat& from, const DQuat& to, double step_s) {
  DQuat turn = to * glm::conjugate(from);
  if (turn.w < 0) turn = -turn;
  const DVec3 axis(turn.x, turn.y, turn.z);
  const double sine = glm::length(axis);
  return sine > 0 ? axis / sine * (2 * std::atan2(sine, turn.w) / step_s) : DVec3(0);
}

}  // namespace

HandPose between(const HandPose& from, const HandPose& to, double share) {
  return {.place_m = glm::mix(from.place_m, to.place_m, share),
          .orientation = glm::slerp(from.orientation, to.orientation, share)};
}

ToolBody::ToolBody(const MatterTool& tool, double step_s) : mass_kg_(tool.mass_kg), step_s_(step_s) {
  const double angular = 2 * kPi * kCouplingFrequency_Hz;
  stiffness_N_m_ = mass_kg_ * angular * angular;
  damping_Ns_m_ = 2 * mass_kg_ * angular;
}

void ToolBody::placeAt(const HandPose& hand) {
  hand_ = hand;
  motion_ = {.place = hand.place_m, .orientation = hand.orientation};
  springImpulse_ = handImpulse_ = DVec3(0);
  exchanged_ = {};
  portEnergy_J_ = 0;
}

void ToolBody::predict(const HandPose& hand) {
  const DVec3 handMove = hand.place_m - hand_.place_m;
  const DVec3 before = motion_.velocity;
  // Implicit, so that no mass and no step is too small for the spring.
  const double share = damping_Ns_m_ * step_s_ / mass_kg_ + stiffness_N_m_ * step_s_ * step_s_ / mass_kg_;
  const DVec3 pull = (stiffness_N_m_ * step_s_ * (hand.place_m - motion_.place) + damping_Ns_m_ * handMove) / mass_kg_;
  motion_.velocity = (before + pull) / (1 + share);
  motion_.place += step_s_ * motion_.velocity;
  motion_.spin = spinBetween(motion_.orientation, hand.orientation, step_s_);
  motion_.orientation = hand.orientation;
  const DVec3 impulse = mass_kg_ * (motion_.velocity - before);
  springImpulse_ += impulse;
  handImpulse_ += impulse;
  portEnergy_J_ += glm::dot(impulse / step_s_, handMove);
  hand_ = hand;
}

void ToolBody::react(const Exchange& exchange) {
  const DVec3 change = exchange.impulse / mass_kg_;
  motion_.velocity += change;
  motion_.place += step_s_ * change;
  exchanged_.impulse += exchange.impulse;
  exchanged_.angular += exchange.angular;
}

ToolAnswer ToolBody::takeAnswer(double duration_s) {
  const ToolAnswer answer{.force_N = -springImpulse_ / duration_s,
                          .torque_Nm = exchanged_.angular / duration_s,
                          .reaction_N = exchanged_.impulse / duration_s,
                          .place_m = motion_.place};
  springImpulse_ = DVec3(0);
  exchanged_ = {};
  return answer;
}

}  // namespace palpate
