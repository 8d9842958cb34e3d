#include "haptics/session/asked_hand.hpp"

#include <cmath>

namespace palpate {

namespace {

bool isSane(const Contact& contact) {
  return contact.valid && isFinite(contact.proxy) && isFinite(contact.normal) && isFinite(contact.velocity) &&
         isFinite(contact.force_N.value_or(DVec3(0)));
}

}  // namespace

AskedHand::AskedHand(Session& session, const AskedHandOptions& options)
    : session_(session), budget_us_(options.budget_us), law_(session.config().force, session.model().scale) {
  law_.setCustom(options.law);
  const HandSpring spring = springOf(law_);
  session.backend().setSprings({&spring, 1});
  session.backend().resetHand(0);
  if (budget_us_ == 0) takesEdits_ = session.relay().begin(session.config().rate_Hz, false);
}

AskedTick AskedHand::tick(const Pose& pose) noexcept {
  const double dt_s = lastTime_s_ ? pose.time_s - *lastTime_s_ : 1 / session_.config().rate_Hz;
  lastTime_s_ = pose.time_s;
  AskedTick tick{.contact = session_.backend().query(pose, budget_us_)};
  if (!isSane(tick.contact)) tick.contact = {.proxy = pose.hip, .lost = tick.contact.lost};
  tick.force_N = law_.update(tick.contact, pose, dt_s);
  if (tick.contact.touching) tick.penetration_mm = law_.scale().toMm(glm::length(tick.contact.proxy - pose.hip));
  session_.backend().prepare();
  if (!takesEdits_ || failure_) return tick;
  try {
    takesEdits_({.time_s = pose.time_s});
  } catch (...) {
    failure_ = std::current_exception();
  }
  return tick;
}

void AskedHand::lift() noexcept {
  session_.backend().resetHand(0);
  law_.reset();
  lastTime_s_.reset();
}

void AskedHand::check() const {
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace palpate
