#include "haptics/session/asked_hands.hpp"

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

AskedHands::AskedHands(Session& session, const AskedHandsOptions& options)
    : session_(session), budget_us_(options.budget_us) {
  TouchBackend& backend = session.backend();
  const ForceLaw law(session.config().force, session.model().scale);
  laws_.assign(backend.hands(), law);
  hands_.resize(backend.hands());
  laws_.front().setCustom(options.law);
  for (std::size_t i = 0; i < laws_.size(); ++i) laws_[i].feelWith(backend.points(i).size());
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const DeviceLimits limits{.peakForce_N = kNone, .continuousForce_N = kNone, .handHeld = false};
  if (session.known()) gates_.assign(laws_.size(), ForceGate(limits, 1 / session.config().rate_Hz));
  backend.begin(budget_us_ > 0, std::vector<HandSpring>(laws_.size(), springOf(law)));
  for (std::size_t i = 0; i < laws_.size(); ++i) backend.resetHand(i);
  if (budget_us_ == 0) takesEdits_ = session.relay().begin(session.config().rate_Hz, false);
}

std::span<const AskedTick> AskedHands::tick(std::span<const Pose> poses) noexcept {
  const double now_s = poses.front().time_s;
  const double dt_s = lastTime_s_ ? now_s - *lastTime_s_ : 1 / session_.config().rate_Hz;
  lastTime_s_ = now_s;
  const std::span<const Contact> answers = session_.backend().ask(poses, budget_us_);
  for (std::size_t i = 0; i < hands_.size(); ++i) feel(i, answers[i], poses[i], dt_s);
  tellOthers(poses);
  session_.backend().prepare();
  if (!takesEdits_ || failure_) return hands_;
  try {
    takesEdits_({.time_s = now_s});
  } catch (...) {
    failure_ = std::current_exception();
  }
  return hands_;
}

void AskedHands::tellOthers(std::span<const Pose> poses) noexcept {
  HandPlaces places{.count = static_cast<std::uint32_t>(hands_.size())};
  for (std::size_t i = 0; i < hands_.size(); ++i)
    places.hands[i] = {.position = poses[i].hip,
                       .proxy = hands_[i].contact.proxy,
                       .touching = hands_[i].contact.touching,
                       .sculpts = i == 0 && session_.config().brush.has_value() && poses[i].sculpts};
  if (SharedFollower* const shared = session_.shared()) shared->moved(places);
  if (SharedPresence* const presence = session_.presence()) presence->moved(places);
}

void AskedHands::feel(std::size_t hand, const Contact& answer, const Pose& pose, double dt_s) noexcept {
  AskedTick& tick = hands_[hand];
  tick = {.contact = answer};
  if (!isSane(answer)) tick.contact = {.proxy = pose.hip, .lost = answer.lost};
  ForceLaw& law = laws_[hand];
  if (const InformationAge* const known = session_.known()) law.setChanging(known->isChanging());
  const std::span<const PointContact> points = session_.backend().points(hand);
  tick.force_N = points.empty() ? law.update(tick.contact, pose, dt_s) : law.update(tick.contact, points, pose, dt_s);
  tick.torque_mNm = law.torque_mNm();
  if (!gates_.empty()) holdBack(hand, dt_s);
  if (tick.contact.touching) tick.penetration_mm = law.scale().toMm(glm::length(tick.contact.proxy - pose.hip));
}

// Reacts only to silence of the server: the timing of the ticks is the caller's task.
void AskedHands::holdBack(std::size_t hand, double dt_s) noexcept {
  AskedTick& tick = hands_[hand];
  ForceGate& gate = gates_[hand];
  const InformationAge& known = *session_.known();
  const TickSigns signs{.on = known.isTrue(), .known = known.share(), .demand_N = laws_[hand].demand_N()};
  tick.force_N = gate.pass(tick.force_N, signs, std::clamp(dt_s, 0.0, 1 / session_.config().rate_Hz));
  tick.torque_mNm *= gate.share();
}

void AskedHands::lift() noexcept {
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    session_.backend().resetHand(i);
    laws_[i].reset();
  }
  lastTime_s_.reset();
}

void AskedHands::check() const {
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace palpate
