#include "haptics/session/pulled_hands.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {

namespace {

bool isSane(const Contact& contact) {
  return contact.valid && isFinite(contact.proxy) && isFinite(contact.normal) && isFinite(contact.velocity) &&
         isFinite(contact.force_N.value_or(DVec3(0)));
}

}  // namespace

HandSpring springOf(const ForceLaw& law) {
  return {.stiffness_N_per_unit = law.options().stiffness_N_per_mm * law.scale().mm_per_unit,
          .damping_N_s_per_unit = law.options().damping_N_s_per_mm * law.scale().mm_per_unit,
          .most_N = law.options().maxForce_N};
}

PulledHands::PulledHands(PulledParts parts, const PullOptions& options)
    : parts_(std::move(parts)), budget_us_(options.budget_us) {
  TouchBackend& backend = parts_.backend;
  const ForceLaw law(parts_.config.force, parts_.scale);
  laws_.assign(backend.hands(), law);
  hands_.resize(backend.hands());
  laws_.front().setCustom(options.law);
  for (std::size_t i = 0; i < laws_.size(); ++i) laws_[i].feelWith(backend.points(i).size());
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const DeviceLimits limits{.peakForce_N = kNone, .continuousForce_N = kNone, .handHeld = false};
  if (parts_.known) gates_.assign(laws_.size(), ForceGate(limits, 1 / parts_.config.rate_Hz));
  backend.begin(budget_us_ > 0, std::vector<HandSpring>(laws_.size(), springOf(law)));
  for (std::size_t i = 0; i < laws_.size(); ++i) backend.resetHand(i);
}

std::span<const PulledTick> PulledHands::tick(std::span<const Pose> poses) noexcept {
  const double now_s = poses.front().time_s;
  const double dt_s = lastTime_s_ ? now_s - *lastTime_s_ : 1 / parts_.config.rate_Hz;
  lastTime_s_ = now_s;
  const std::span<const Contact> answers = parts_.backend.ask(poses, budget_us_);
  for (std::size_t i = 0; i < hands_.size(); ++i) feel(i, answers[i], poses[i], dt_s);
  publish(poses);
  parts_.backend.prepare();
  if (!parts_.takesEdits || failure_) return hands_;
  try {
    parts_.takesEdits({.time_s = now_s});
  } catch (...) {
    failure_ = std::current_exception();
  }
  return hands_;
}

void PulledHands::publish(std::span<const Pose> poses) noexcept {
  HandPlaces places{.count = static_cast<std::uint32_t>(hands_.size())};
  for (std::size_t i = 0; i < hands_.size(); ++i)
    places.hands[i] = {.position = poses[i].hip,
                       .proxy = hands_[i].contact.proxy,
                       .touching = hands_[i].contact.touching,
                       .sculpts = i == 0 && parts_.config.brush.has_value() && poses[i].sculpts};
  parts_.others.publish(places);
}

void PulledHands::feel(std::size_t hand, const Contact& answer, const Pose& pose, double dt_s) noexcept {
  PulledTick& tick = hands_[hand];
  tick = {.contact = answer};
  if (!isSane(answer)) tick.contact = {.proxy = pose.hip, .lost = answer.lost};
  ForceLaw& law = laws_[hand];
  const std::span<const PointContact> points = parts_.backend.points(hand);
  tick.force_N = points.empty() ? law.update(tick.contact, pose, dt_s) : law.update(tick.contact, points, pose, dt_s);
  tick.torque_mNm = law.torque_mNm();
  if (!gates_.empty()) holdBack(hand, dt_s);
  if (tick.contact.touching) tick.penetration_mm = law.scale().toMm(glm::length(tick.contact.proxy - pose.hip));
}

// Reacts only to silence of the server: the timing of the ticks is the caller's task.
void PulledHands::holdBack(std::size_t hand, double dt_s) noexcept {
  PulledTick& tick = hands_[hand];
  ForceGate& gate = gates_[hand];
  const InformationAge& known = *parts_.known;
  const TickSigns signs{.on = known.isTrue(), .known = known.share(), .demand_N = laws_[hand].demand_N()};
  tick.force_N = gate.pass(tick.force_N, signs, std::clamp(dt_s, 0.0, 1 / parts_.config.rate_Hz));
  tick.torque_mNm *= gate.share();
}

void PulledHands::lift() noexcept {
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    parts_.backend.resetHand(i);
    laws_[i].reset();
  }
  lastTime_s_.reset();
}

void PulledHands::check() const {
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace palpate
