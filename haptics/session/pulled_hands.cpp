#include "haptics/session/pulled_hands.hpp"

#include <limits>

namespace palpate {

HandSpring springOf(const ForceLaw& law) {
  return {.stiffness_N_per_unit = law.options().stiffness_N_per_mm * law.scale().mm_per_unit,
          .damping_N_s_per_unit = law.options().damping_N_s_per_mm * law.scale().mm_per_unit,
          .most_N = law.options().maxForce_N};
}

PulledHands::PulledHands(PulledParts parts, const PullOptions& options)
    : parts_(std::move(parts)), options_(options), hands_(parts_.backend.hands()) {
  TouchBackend& backend = parts_.backend;
  ForceLaw law(parts_.config.force, parts_.scale);
  begin(law);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  law.setCustom(options.law);
  for (std::size_t i = 0; i < hands_.size(); ++i, law.setCustom({})) {
    forces_.emplace_back(
        law, HandForceOptions{.limits = {.peakForce_N = kNone, .continuousForce_N = kNone, .handHeld = false},
                              .rate_Hz = parts_.config.rate_Hz,
                              .toolPoints = backend.points(i).size(),
                              .guardsTicks = false});
    backend.resetHand(i);
  }
}

PulledHands::PulledHands(PulledParts parts, PulledState state) : PulledHands(std::move(parts), state.options) {
  parts_.backend.restoreContacts(state.contacts);
  forces_ = std::move(state.forces);
  lastTime_s_ = state.lastTime_s;
}

void PulledHands::begin(const ForceLaw& law) {
  parts_.backend.begin(options_.budget_us > 0, std::vector<HandSpring>(hands_.size(), springOf(law)));
}

void PulledHands::setForce(const ForceOptions& options) {
  for (HandForce& force : forces_) force.setOptions(options);
  begin(forces_.front().law());
}

PulledState PulledHands::state() const {
  return {.options = options_, .forces = forces_, .contacts = parts_.backend.contacts(), .lastTime_s = lastTime_s_};
}

std::span<const PulledTick> PulledHands::tick(std::span<const Pose> poses) noexcept {
  const double now_s = poses.front().time_s;
  const double dt_s = lastTime_s_ ? now_s - *lastTime_s_ : 1 / parts_.config.rate_Hz;
  lastTime_s_ = now_s;
  runTick(
      {.query = parts_.backend, .poses = poses, .budget_us = options_.budget_us, .dt_s = dt_s, .known = parts_.known},
      forces_, [&] {
        for (std::size_t i = 0; i < hands_.size(); ++i)
          hands_[i] = {.contact = forces_[i].contact(),
                       .force_N = forces_[i].force_N(),
                       .torque_mNm = forces_[i].torque_mNm(),
                       .penetration_mm = forces_[i].penetration_mm(),
                       .withheld = forces_[i].isWithheld()};
        publish(poses);
      });
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

void PulledHands::lift() noexcept {
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    parts_.backend.resetHand(i);
    forces_[i].lift();
  }
  lastTime_s_.reset();
}

void PulledHands::check() const {
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace palpate
