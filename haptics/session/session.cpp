#include "haptics/session/session.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/gaussian_records.hpp"
#include "engine/core/job_stop.hpp"
#include "haptics/session/hiding_touch.hpp"
#include "haptics/session/recorded_contacts.hpp"
#include "haptics/session/session_setup.hpp"
#include "haptics/session/stream_model.hpp"

namespace palpate {

namespace {

constexpr double kRelay_Hz = 30;         // of taking edits against the clock
constexpr double kSharedRelay_Hz = 400;  // and if others wait for them

}  // namespace

Session::Session(SessionConfig config, std::shared_ptr<const Model> model, const SessionParts& parts)
    : kind_(parts.backend),
      config_(checked(std::move(config), kind_)),
      scene_{{Layer{std::move(model)}}},
      surface_(kind_.surface(this->model(), config_.surface)),
      stream_(takeStream(config_, this->model())),
      fusion_(fusedStream(config_, scene_.layers[0].model, stream_, parts.threads, parts.log)),
      source_(fusion_ && kind_.capabilities().fusesFrames ? nullptr
                                                          : makeSource(config_, this->model(), stream_, fusion_)),
      isMoved_(parts.source != nullptr),
      backend_(makeTouch(parts)),
      machine_(backend_->report().machine),
      followers_(make(parts.followers)),
      shared_(takePart()),
      sharedPatience_s_(parts.sharedPatience_s),
      log_(parts.log),
      relay_(this->model().cloud, scene_.layers[0].attributes, backend_->edits(), backend_->shapeStrokes(),
             {.followers = followers(),
              .rate_Hz = shared_ ? kSharedRelay_Hz : kRelay_Hz,
              .keepsPoints = (parts.keepsPoints || shared_) && kind_.capabilities().keepsEdits,
              .isPart = farTouch_ != nullptr,
              .undo = parts.undo}),
      channel_({.config = config_,
                .settle =
                    [this] {
                      if (channel_.isLent() || (live_ && live_->isStarted())) takeEdits();
                    },
                .log = log_}),
      isPaintable_(parts.paintable) {
  // No file tells a replay the scale, so the configuration must.
  if (config_.model.join) config_.model.mm_per_unit = this->model().scale.mm_per_unit;
  built_ = config_;
  if (config_.brush) relay_.applyMasks();  // the file may have locks
}

Session::Session(SessionConfig config, Model model, const SessionParts& parts)
    : Session(std::move(config), std::make_shared<const Model>(std::move(model)), parts) {}

Session::~Session() {
  stop();
  relay_.stop();
}

std::unique_ptr<TouchBackend> Session::makeTouch(const SessionParts& parts) {
  MadeBackend made = makeBackend({.kind = kind_,
                                  .config = config_,
                                  .model = model(),
                                  .surface = surface_,
                                  .threads = parts.threads,
                                  .paintable = parts.paintable,
                                  .source = isMoved_ ? parts.source : source_.get(),
                                  .fusion = fusion_,
                                  .engine = parts.engine});
  farTouch_ = made.far;
  if (farTouch_ || !parts.keepsPoints) return std::move(made.touch);
  return std::make_unique<HidingTouch>(std::move(made.touch));
}

std::vector<std::unique_ptr<EditFollower>> Session::make(const std::vector<FollowerMaker>& makers) const {
  std::vector<std::unique_ptr<EditFollower>> made;
  made.reserve(makers.size());
  for (const FollowerMaker& each : makers) made.push_back(each(model(), *backend_));
  return made;
}

std::vector<EditFollower*> Session::followers() const {
  std::vector<EditFollower*> all;
  if (shared_) all.push_back(shared_.get());
  for (const auto& each : followers_) all.push_back(each.get());
  return all;
}

std::unique_ptr<SharedFollower> Session::takePart() {
  const SharedMaker share = model().share();
  if (!share) {
    if (config_.model.join && config_.brush && !model().far()) throw Error("{}", fixedBecause(config_, model()));
    return nullptr;
  }
  if (!backend_->edits() || backend_->edits()->mostOffered() == 0)
    throw Error(
        "{}: '{}' is sculpted by others, which {} cannot follow; use another back end, or serve the model with "
        "--read-only",
        config_.backend.name, config_.model.file, config_.backend.name);
  return share(model().cloud, *backend_);
}

std::optional<PlayCounts> Session::playCounts() const {
  if (!stream_ || !stream_->player) return std::nullopt;
  return stream_->player->counts();
}

std::optional<PlayedView> Session::playedView() const {
  if (!stream_ || !stream_->player) return std::nullopt;
  return stream_->player->view();
}

double Session::durationOf(std::span<const OpenHand> hands) const {
  if (config_.duration_s > 0) return config_.duration_s;
  double longest_s = 0;
  for (const OpenHand& hand : hands) longest_s = std::max(longest_s, hand.duration_s);
  return longest_s;
}

// The spring that each hand feels, within the limits of its device.
std::vector<HandSpring> Session::springs(std::span<const OpenHand> hands) const {
  std::vector<HandSpring> springs;
  for (const OpenHand& hand : hands) {
    ForceLaw law(config_.force, model().scale);
    const DeviceLimits limits = hand.device->limits();
    law.limitTo(limits.peakForce_N, limits.mostStiffness_N_per_mm);
    springs.push_back(springOf(law));
  }
  return springs;
}

// Waits for the points at the beginning of each script. For a held device the first position is not known in advance.
void Session::awaitPoints(std::span<const OpenHand> hands, const RunOptions& options) const {
  std::vector<DVec3> hips;
  for (const OpenHand& hand : hands) {
    if (hand.device->limits().handHeld) return;
    hips.push_back(hand.map.toModel(hand.device->read(options.begin_s).position));
  }
  constexpr double kBefore_s = 1e-6;  // before the first tick
  farTouch_->awaitAt(options.begin_s - kBefore_s, hips, sharedPatience_s_);
  model().far()->check();
}

const InformationAge* Session::known() const {
  if (shared_) return &shared_->known();
  return model().far() ? &model().far()->known() : nullptr;
}

ServoResult Session::run(std::span<const OpenHand> hands, const RunOptions& options) {
  const bool realtime = config_.realtime || options.realtime;
  if (model().far() && model().far()->moves() && !realtime)
    throw Error("'{}' moves in real time; join it with --realtime", config_.model.file);
  backend_->begin(realtime, springs(hands));
  std::vector<SessionHand> touching;
  for (const OpenHand& hand : hands)
    touching.push_back({.device = *hand.device,
                        .law = ForceLaw(config_.force, model().scale),
                        .options = {.map = hand.map, .passivity = hand.passivity}});
  if (!touching.empty()) touching.front().law.setCustom(options.law);
  const double rate_Hz = options.rate_Hz > 0 ? options.rate_Hz : config_.rate_Hz;
  HandPublisher publisher(shared_.get(), presence(), touching.size(), config_.brush.has_value());
  Recorders recorders(recording(), {options.recorder, &publisher});
  if (!options.endless) settleShared(sharedPatience_s_);  // takes in the edits made before this hand joined
  if (farTouch_) awaitPoints(hands, options);
  const JobStopScope whole(JobStopScope::whole());  // no tick is cut short
  LendableQuery query(options.query ? *options.query : *backend_);
  std::vector<double> state;
  if (!options.resume.empty()) state = restoreContacts(options.resume, *backend_);
  ServoLoop loop(query, touching,
                 {.rate_Hz = rate_Hz,
                  .duration_s = durationOf(hands) + 1 / rate_Hz,  // the path's end is a tick too
                  .begin_s = options.begin_s,
                  .endless = options.endless,
                  .realtime = realtime,
                  .clock = options.clock,
                  .stop = options.stop ? options.stop : jobStop.flag,
                  .forcesOn = options.forcesOn,
                  .known = known(),
                  .recorder = &recorders,
                  .mailbox = options.endless ? &channel_.mailbox() : nullptr,
                  .resume = state});
  if (!state.empty()) {
    StateNumbers numbers = StateNumbers::from(std::span(state).subspan(std::min(loop.stateSize(), state.size())));
    if (numbers.reads()) query.visitState(numbers);
  }
  RunningLoop running(loop, query, recorders, publisher);
  const CommandChannel::Running scope(channel_, running);
  if (options.endless) return loop.run();  // the thread that displays the session takes the edits
  const TickObserver relays = relay_.begin(rate_Hz, realtime);
  const auto run = [&] {
    if (!options.observer) return loop.run(relays, options.before);
    return loop.run(
        [&](const TraceRow& row) {
          if (relays) relays(row);
          options.observer(row);
        },
        options.before);
  };
  ServoResult result = run();
  if (!result.trace().rows.empty()) last_s_ = result.trace().rows.back().time_s;
  return result;
}

void Session::start(std::vector<OpenHand> hands, const LiveRunOptions& options) {
  LiveRunOptions live = options;
  if (live.rate_Hz <= 0) live.rate_Hz = config_.rate_Hz;
  const LiveRun::Play play = [this](std::span<const OpenHand> touching, const LiveRunOptions& how,
                                    const std::atomic<bool>& stop, TickRecorder& recorder) {
    ServoResult result = run(touching, {.begin_s = how.begin_s,
                                        .rate_Hz = how.rate_Hz,
                                        .endless = true,
                                        .clock = how.clock.get(),
                                        .stop = &stop,
                                        .forcesOn = how.forcesOn,
                                        .recorder = &recorder,
                                        .realtime = true,
                                        .law = how.law});
    if (result.queryLost) result.fault = machine_ + " was lost; earlier results are kept";
    return result;
  };
  live_.reset();
  live_ = std::make_shared<LiveRun>(std::move(hands), live, channel_.mailbox(), play);
}

void Session::stop() {
  if (live_) live_->pause();
}

PulledParts Session::pulledParts(const PullOptions& options) {
  return {.backend = *backend_,
          .config = config_,
          .scale = model().scale,
          .known = known(),
          .others = {shared(), presence(), backend_->hands(), config_.brush.has_value()},
          .takesEdits = options.budget_us == 0 ? relay_.begin(config_.rate_Hz, false) : TickObserver()};
}

void Session::pull(const PullOptions& options) { pulled_.emplace(pulledParts(options), options); }

void Session::resumePulling(PulledState state) {
  PulledParts parts = pulledParts(state.options);
  pulled_.emplace(std::move(parts), std::move(state));
}

void Session::endPulling() {
  if (!pulled_) return;
  const PulledHands ended = *std::exchange(pulled_, std::nullopt);
  ended.check();
}

void Session::checkPulling() {
  if (pulled_ && pulled_->hasFailed()) endPulling();
}

void Session::finish() {
  if (model().far()) model().far()->check();
  backend_->finish();
  relay_.finish();
  settleShared(sharedPatience_s_);
}

Abilities Session::abilities() const {
  return Abilities(modelKindOf(config_, model(), isMoved_), kind_.capabilities(), kind_.name());
}

void Session::require(Action action, std::string_view what) const {
  const Abilities can = abilities();
  if (!can.allow(action)) throw Error("{}: {}", what, can.refusal(action));
}

StrokeCounts Session::strokes() const { return history() ? history()->counts() : StrokeCounts{}; }

SculptedCloud Session::sculpted() const {
  SculptedCloud sculpted{.cloud = model().cloud};
  if (pointHistory() && !config_.moves() && !isMoved_) {
    const PointStates& points = history()->points();
    sculpted.cloud = editedCloud(model().cloud, points, scene_.layers[0].attributes.fields());
    sculpted.edited = changedPoints(model().cloud, points);
    return sculpted;
  }
  if (config_.moves() || isMoved_) forgetGaussians(sculpted.cloud);  // they do not follow the frames
  sculpted.edited = backend_->readBack(sculpted.cloud);
  if (!model().far() || model().far()->moves()) return sculpted;
  sculpted.remark =
      fmt::format("{} of {} points, those known around the hands; the field 'number' has their numbers among all",
                  sculpted.cloud.size(), model().extent()->points);
  sculpted.cloud.storedAs.comments.push_back("comment palpate: " + sculpted.remark);
  return sculpted;
}

}  // namespace palpate
