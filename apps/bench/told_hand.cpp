#include "apps/bench/told_hand.hpp"

#include <limits>

namespace palpate {

namespace {

constexpr double kChange_N = 0.001;  // far below the smallest force that a hand can feel, far above the changes at rest

}  // namespace

void ToldHand::goTo(const DVec3& place, bool isPutDown) {
  target_.store({.place = place, .number = ++told_, .isPutDown = isPutDown});
}

std::optional<double> ToldHand::arrived_s() const {
  const std::optional<Arrival> arrival = arrival_.load();
  if (!arrival || arrival->number != told_) return std::nullopt;
  return arrival->time_s;
}

void ToldHand::watch() {
  changed_s_ = -1;
  isWatching_ = true;
}

std::optional<double> ToldHand::changed_s() const {
  const double changed_s = changed_s_;
  return changed_s < 0 ? std::nullopt : std::optional(changed_s);
}

DeviceLimits ToldHand::limits() const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return {.peakForce_N = kNone, .continuousForce_N = kNone, .fastest_mm_per_s = kNone, .handHeld = false};
}

DeviceState ToldHand::read(double) noexcept {
  DeviceState state{.ok = true};
  if (const auto target = target_.load(); target && target->number != now_.number) {
    now_ = *target;
    state.putDown = now_.isPutDown;
    arrival_.store({.number = now_.number, .time_s = clock_.elapsed_s()});
  }
  state.position = now_.place;
  return state;
}

bool ToldHand::write(const DVec3& force_N) noexcept {
  last_.now_s = clock_.elapsed_s();
  if (glm::distance(force_N, last_.force_N) > kChange_N) {
    last_.force_N = force_N;
    last_.since_s = last_.now_s;
    if (isWatching_.exchange(false)) changed_s_ = last_.now_s;
  }
  felt_.store(last_);
  return true;
}

}  // namespace palpate
