#include "haptics/session/stepped_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptics/session/session.hpp"
#include "haptics/session/stream_model.hpp"

namespace palpate {

namespace {

constexpr double kBodyRate_Hz = 500;       // rate of the poses of the hands
constexpr double kBudget_us = 1000;        // maximum wait for an answer
constexpr double kBetweenPlaces_s = 0.02;  // time constant with which a hand follows its reported positions
constexpr double kFastest_mm_s = 2000;     // maximum speed of a hand

// The session of matter: with the maximum number of hands.
SessionConfig withAllHands(SessionConfig config) {
  config.hands.assign(kMaxHands, HandConfig{});
  config.realtime = true;
  config.brush.reset();
  config.tool = {};
  return config;
}

}  // namespace

SteppedModel::SteppedModel(const SessionConfig& config, std::shared_ptr<const Model> model, const Parts& parts)
    : model_(std::move(model)), log_(parts.log) {
  validate(config);
  if (!config.moves()) throw ConfigError("motion.kind", "nothing moves the model");
  if (!config.model.matter) {
    stream_ = takeStream(config, *model_);
    fusion_ = fusedStream(config, model_, stream_, parts.threads, parts.log);
    source_ = makeSource(config, *model_, stream_, fusion_);
    return;
  }
  matter_.emplace(withAllHands(config), model_, SessionParts{.backend = parts.backend, .threads = parts.threads});
  matter_->pull({.budget_us = kBudget_us});
  particles_ = model_->cloud.size() - model_->standing();
  fastest_ = model_->scale.toUnits(kFastest_mm_s);
  for (Slot& slot : slots_) slot.hip = nowhere();
}

SteppedModel::~SteppedModel() = default;

double SteppedModel::rate_Hz() const { return matter_ ? kBodyRate_Hz : kFrames_Hz; }

DVec3 SteppedModel::nowhere() const {
  constexpr double kFar = 1e3;  // longest sides
  const Bounds box = boundsOf(model_->cloud);
  return model_->cloud.origin + box.center() + DVec3(0, 0, kFar * std::max(box.longestSide(), 1.0));
}

bool SteppedModel::step(double time_s, std::span<SeenHand> hands, CloudFrame& frame) {
  if (matter_) {
    move(time_s, hands);
    constexpr double kRounding_s = 1e-4;
    if (shown_s_ && time_s < *shown_s_ + 1 / kFrames_Hz - kRounding_s) return false;
    if (!matter_->backend().frames()->take(frame)) return false;
    leaveParticles(frame);
  } else {
    if (shown_s_ && !source_->hasNewer(time_s, frameTime_s_)) return false;
    source_->makeFrame(time_s, frame);
    requireWhole(frame, source_->size());
    if (shown_s_ && frame.time_s == frameTime_s_) return false;
    frameTime_s_ = frame.time_s;
  }
  shown_s_ = time_s;
  return true;
}

// Assigns the hands to slots, which they keep; without a free slot a hand is ignored.
void SteppedModel::seat(std::span<const SeenHand> hands, double since_s) {
  for (Slot& slot : slots_) slot.seen = false;
  for (const SeenHand& hand : hands) {
    auto slot = std::ranges::find(slots_, hand.number, &Slot::number);
    const bool isNew = slot == slots_.end();
    if (isNew) slot = std::ranges::find_if(slots_, [](const Slot& one) { return !one.number; });
    if (slot == slots_.end()) continue;
    slot->seen = true;
    // A hand that moves faster than the maximum was put down elsewhere.
    const bool isPutDown = isNew || glm::distance(slot->hip, hand.place.position) > fastest_ * kBetweenPlaces_s;
    const double share = isPutDown ? 1 : 1 - std::exp(-since_s / kBetweenPlaces_s);
    slot->hip = glm::mix(slot->hip, hand.place.position, share);
    if (isPutDown) matter_->backend().resetHand(static_cast<std::size_t>(slot - slots_.begin()));
    slot->number = hand.number;
  }
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].seen || !slots_[i].number) continue;
    slots_[i] = {.number = std::nullopt, .hip = nowhere()};
    matter_->backend().resetHand(i);
  }
}

void SteppedModel::move(double time_s, std::span<SeenHand> hands) {
  seat(hands, last_s_ ? time_s - *last_s_ : 0);
  last_s_ = time_s;
  std::array<Pose, kMaxHands> poses;
  for (std::size_t i = 0; i < slots_.size(); ++i) poses[i] = {.time_s = time_s, .hip = slots_[i].hip, .sculpts = false};
  const std::span<const PulledTick> ticks = matter_->tick(poses);
  if (ticks.front().contact.lost) matter_->backend().finish();
  for (SeenHand& hand : hands) {
    const auto slot = std::ranges::find(slots_, hand.number, &Slot::number);
    if (slot == slots_.end()) continue;
    const Contact& contact = ticks[static_cast<std::size_t>(slot - slots_.begin())].contact;
    if (contact.valid && contact.touching) hand.force_N = contact.force_N.value_or(DVec3(0));
  }
  restart();
}

Restarts SteppedModel::restarts() const {
  const std::scoped_lock hold(lock_);
  return restarts_;
}

// A failure caused by one hand must not end the simulation for the others. A failure that persists after a restart
// leads to another one.
void SteppedModel::restart() {
  constexpr double kAgain_s = 0.5;
  SimulationControl* const control = matter_->simulation();
  const std::string failure = control ? control->failure() : std::string();
  const bool wasFailing = std::exchange(isFailing_, !failure.empty());
  if (failure.empty() || (wasFailing && sinceRestart_.elapsed_s() < kAgain_s))
    return;  // the last reset takes effect with the next step
  sinceRestart_ = {};
  if (!wasFailing) {
    if (log_) log_->warn("the simulation {}: it is restarted", failure);
    const std::scoped_lock hold(lock_);
    restarts_ = {.count = restarts_.count + 1, .why = failure};
  }
  control->reset();
}

// Removes the standing points, which all participants have.
void SteppedModel::leaveParticles(CloudFrame& frame) const {
  if (model_->standing() == 0) return;
  for (std::vector<Vec3>* values : {&frame.positions, &frame.normals, &frame.velocities})
    if (values->size() > particles_) values->resize(particles_);
}

}  // namespace palpate
