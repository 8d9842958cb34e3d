#include "haptics/session/stepped_model.hpp"

#include <algorithm>
#include <cmath>

#include "haptics/session/session.hpp"
#include "haptics/session/stream_model.hpp"

namespace palpate {

namespace {

constexpr double kBodyRate_Hz = 500;       // hands are where they are so often
constexpr double kBudget_us = 1000;        // and wait so long for an answer
constexpr double kBetweenPlaces_s = 0.02;  // in which a hand is where it was said to be

// A soft body with as many hands as there can be.
std::unique_ptr<TouchBackend> softBody(SessionConfig config, const Model& model, const SteppedModel::Parts& parts) {
  config.hands.assign(kMostHands, HandConfig{});
  config.realtime = true;
  validate(config);
  parts.backend.check(config);
  auto body = parts.backend.make({.model = model,
                                  .config = config,
                                  .surface = parts.backend.surface(model, config.surface),
                                  .brush = std::nullopt,
                                  .tools = std::vector<ToolShape>(kMostHands),
                                  .threads = parts.threads,
                                  .source = nullptr,
                                  .fusion = std::nullopt});
  body->setSprings(std::vector<HandSpring>(kMostHands, springOf(ForceLaw(config.force, model.scale))));
  body->setRealtime(true);
  return body;
}

}  // namespace

SteppedModel::SteppedModel(const SessionConfig& config, std::shared_ptr<const Model> model, const Parts& parts)
    : model_(std::move(model)) {
  validate(config);
  if (!config.moves()) throw ConfigError("motion.kind", "nothing moves the model");
  if (!config.matter) {
    stream_ = takeStream(config, *model_);
    fusion_ = fusedStream(config, model_, stream_, parts.threads, parts.log);
    source_ = makeSource(config, *model_, stream_, fusion_);
    return;
  }
  if (config.matter->matter != Matter::soft)
    throw ConfigError(
        "matter",
        "of water and sand a hand feels what they do to a ball that it holds there, and no surface, which is "
        "all that goes over a network; take a soft body");
  body_ = softBody(config, *model_, parts);
  for (Slot& slot : slots_) slot.hip = nowhere();
}

SteppedModel::~SteppedModel() = default;

double SteppedModel::rate_Hz() const { return body_ ? kBodyRate_Hz : kFrames_Hz; }

DVec3 SteppedModel::nowhere() const {
  constexpr double kFar = 1e3;  // longest sides
  const Bounds box = boundsOf(model_->cloud);
  return model_->cloud.origin + box.center() + DVec3(0, 0, kFar * std::max(box.longestSide(), 1.0));
}

bool SteppedModel::step(double time_s, std::span<const SeenHand> hands, CloudFrame& frame) {
  if (body_) {
    press(time_s, hands);
    constexpr double kRounding_s = 1e-4;
    if (shown_s_ && time_s < *shown_s_ + 1 / kFrames_Hz - kRounding_s) return false;
    if (!body_->takeFrame(frame)) return false;
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

// Each hand keeps its place among the body's; one for whom there is none is not felt by the body.
void SteppedModel::seat(std::span<const SeenHand> hands, double since_s) {
  for (Slot& slot : slots_) slot.seen = false;
  for (const SeenHand& hand : hands) {
    auto slot = std::ranges::find(slots_, hand.number, &Slot::number);
    const bool isNew = slot == slots_.end();
    if (isNew) slot = std::ranges::find_if(slots_, [](const Slot& one) { return !one.number; });
    if (slot == slots_.end()) continue;
    slot->seen = true;
    const double share = isNew ? 1 : 1 - std::exp(-since_s / kBetweenPlaces_s);
    slot->hip = glm::mix(slot->hip, hand.place.position, share);
    if (isNew) body_->resetHand(static_cast<std::size_t>(slot - slots_.begin()));
    slot->number = hand.number;
  }
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].seen || !slots_[i].number) continue;
    slots_[i] = {.number = std::nullopt, .hip = nowhere()};
    body_->resetHand(i);
  }
}

void SteppedModel::press(double time_s, std::span<const SeenHand> hands) {
  seat(hands, last_s_ ? time_s - *last_s_ : 0);
  last_s_ = time_s;
  std::array<Pose, kMostHands> poses;
  for (std::size_t i = 0; i < slots_.size(); ++i) poses[i] = {.time_s = time_s, .hip = slots_[i].hip, .sculpts = false};
  if (const auto answers = body_->ask(poses, kBudget_us); answers.front().lost) body_->finish();
  body_->prepare();
}

}  // namespace palpate
