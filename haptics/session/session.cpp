#include "haptics/session/session.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/core/parallel.hpp"
#include "engine/matter/matter_parameters.hpp"
#include "engine/matter/matter_pond.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/motion/brick_source.hpp"
#include "engine/touch/brick_matter.hpp"
#include "engine/touch/matter_touch.hpp"
#include "haptics/session/stream_model.hpp"

namespace palpate {

namespace {

constexpr double kRelay_Hz = 30;         // of taking edits against the clock
constexpr double kSharedRelay_Hz = 400;  // and if others wait for them
constexpr double kOthersBusy_s = 1;      // maximum wait for others who still edit, once this hand's edits are accepted

SessionConfig checked(SessionConfig config, const BackendKind& kind) {
  validate(config);
  kind.check(config);
  return config;
}

// Why the model cannot be sculpted; empty: it can.
std::string fixedBecause(const SessionConfig& config, const Model& model) {
  const Abilities can(modelKindOf(config, model));
  if (can.allow(Action::sculpt)) return {};
  return fmt::format("{}: {}", config.model.file, can.refusal(Action::sculpt));
}

std::optional<BrushOptions> brushOf(const SessionConfig& config, const Model& model) {
  if (!config.brush) return std::nullopt;
  return brushOptions(*config.brush, model.scale);
}

// Matter that another program simulates: the particles around the hands are simulated here, on the CPU.
std::unique_ptr<TouchBackend> makePond(const SessionConfig& config, const Model& model, const SessionParts& parts) {
  if (config.tool.kind != ToolKind::point) throw ConfigError("tool.kind", "in matter a hand holds the scene's ball");
  const MatterScene& scene = *model.farMatter;
  const std::size_t hands = std::max<std::size_t>(1, config.hands.size());
  BrickSource& source = model.far->source();
  // Some thousand particles, two or more steps per millisecond: threads that wait for one another need a core each.
  constexpr unsigned kMaxThreads = 4;
  const unsigned threads = std::clamp(threadCount(parts.threads) / kMaxThreads, 1U, kMaxThreads);
  constexpr std::uint64_t kMemory_bytes = std::uint64_t{1} << 32;  // limit for a scene from another program
  auto pond = std::make_unique<MatterPond>(
      scene, MatterOptions{.threads = threads, .tools = hands, .memory_bytes = kMemory_bytes, .model = model.standing},
      newsOf(source));
  auto felt =
      std::make_unique<MatterTouch>(std::move(pond), MatterTouchOptions{.hands = hands,
                                                                        .threads = parts.threads,
                                                                        .realtime = true,
                                                                        .machine = cpuBackend()->machine(threads),
                                                                        .varies = true});
  // Reach of the weights.
  const double support = kSupport_spacings * particleSpacing_mm(scene);
  return std::make_unique<BrickTouch>(source, std::move(felt),
                                      BrickTouchOptions{.radius = support,
                                                        .tool = scene.tool.radius_mm,
                                                        .origin = model.cloud.origin,
                                                        .brush = brushOf(config, model),
                                                        .fixed = fixedBecause(config, model)});
}

// A cloud that another program has: only its points around the hands are here and felt.
std::unique_ptr<TouchBackend> makeFarBackend(const SessionConfig& config, const Model& model,
                                             const SurfaceOptions& surface, const SessionParts& parts) {
  if (!parts.backend.capabilities().followsMotion)
    throw ConfigError("backend.name", "{} requires all points in this program; take vulkan or cpu",
                      config.backend.name);
  if (model.farMatter) return makePond(config, model, parts);
  std::vector<ToolShape> tools{toolShape(config.tool, model.scale)};
  double reach = 0;
  for (const ToolPoint& point : tools.front().points) reach = std::max(reach, glm::length(point.place));
  tools.resize(std::max<std::size_t>(1, config.hands.size()));
  BrickSource& source = model.far->source();
  auto felt = parts.backend.make({.model = model,
                                  .config = config,
                                  .surface = surface,
                                  .brush = std::nullopt,
                                  .tools = std::move(tools),
                                  .threads = parts.threads,
                                  .source = &source,
                                  .fusion = std::nullopt});
  return std::make_unique<BrickTouch>(source, std::move(felt),
                                      BrickTouchOptions{.radius = surface.radius,
                                                        .widening = surface.widening,
                                                        .tool = reach,
                                                        .origin = model.cloud.origin,
                                                        .brush = brushOf(config, model),
                                                        .fixed = fixedBecause(config, model)});
}

std::unique_ptr<TouchBackend> makeBackend(const SessionConfig& config, const Model& model,
                                          const SurfaceOptions& surface, const SessionParts& parts, CloudSource* source,
                                          const std::optional<FusedStream>& fusion) {
  if (model.far) return makeFarBackend(config, model, surface, parts);
  std::optional<BrushOptions> brush = brushOf(config, model);
  // Edits of others require editable points, even if this hand has no brush.
  if (model.share && !brush) brush = brushOptions({.keepsDensity = false}, model.scale);
  // Only the first hand has the tool.
  std::vector<ToolShape> tools{toolShape(config.tool, model.scale)};
  tools.resize(std::max<std::size_t>(1, config.hands.size()));
  // Allocates for any later brush, which may keep the density.
  std::optional<BrushOptions> widest = brush;
  if (widest && !model.share) widest->keepsDensity = true;
  auto backend = parts.backend.make({.model = model,
                                     .config = config,
                                     .surface = surface,
                                     .brush = widest,
                                     .paintable = parts.paintable || model.share,
                                     .tools = std::move(tools),
                                     .threads = parts.threads,
                                     .source = source,
                                     .fusion = source ? std::nullopt : fusion});
  if (brush && widest->keepsDensity != brush->keepsDensity) backend->setBrush(brush);
  return backend;
}

/// Notifies all recorders in this order; any may be null.
class Recorders final : public TickRecorder {
 public:
  explicit Recorders(const std::array<TickRecorder*, 3>& all) : all_(all) {}
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override {
    for (TickRecorder* each : all_)
      if (each) each->ticked(row, device);
  }
  void tickedToo(std::size_t hand, const TraceRow& row) noexcept override {
    for (TickRecorder* each : all_)
      if (each) each->tickedToo(hand, row);
  }

 private:
  std::array<TickRecorder*, 3> all_;
};

/// Reports the positions of the hands: to the presence, which shows them to others, and to the shared follower, which
/// applies the changes of others gently where a hand touches.
class ToldHands final : public TickRecorder {
 public:
  /// Either pointer may be null. `hands`: their number. `sculpts`: the first one has a brush.
  ToldHands(SharedFollower* shared, SharedPresence* presence, std::size_t hands, bool sculpts)
      : shared_(shared), presence_(presence), sculpts_(sculpts) {
    places_.count = static_cast<std::uint32_t>(hands);
  }
  void tickedToo(std::size_t hand, const TraceRow& row) noexcept override { places_.hands[hand] = placeOf(row); }
  void ticked(const TraceRow& row, const DeviceState&) noexcept override {
    places_.hands[0] = placeOf(row);
    places_.hands[0].sculpts = sculpts_;
    if (shared_) shared_->moved(places_);
    if (presence_) presence_->moved(places_);
  }

 private:
  static HandPlace placeOf(const TraceRow& row) {
    return {.position = row.hip, .proxy = row.proxy, .touching = row.contact};
  }
  SharedFollower* shared_;
  SharedPresence* presence_;
  bool sculpts_;
  HandPlaces places_;
};

}  // namespace

HandSpring springOf(const ForceLaw& law) {
  return {.stiffness_N_per_unit = law.options().stiffness_N_per_mm * law.scale().mm_per_unit,
          .damping_N_s_per_unit = law.options().damping_N_s_per_mm * law.scale().mm_per_unit,
          .most_N = law.options().maxForce_N};
}

Session::Session(SessionConfig config, std::shared_ptr<const Model> model, const SessionParts& parts)
    : kind_(parts.backend),
      config_(checked(std::move(config), kind_)),
      model_(std::move(model)),
      surface_(kind_.surface(*model_, config_.surface)),
      stream_(takeStream(config_, *model_)),
      fusion_(fusedStream(config_, model_, stream_, parts.threads, parts.log)),
      source_(fusion_ && kind_.capabilities().fusesFrames ? nullptr : makeSource(config_, *model_, stream_, fusion_)),
      isMoved_(parts.source != nullptr),
      backend_(makeBackend(config_, *model_, surface_, parts, isMoved_ ? parts.source : source_.get(), fusion_)),
      machine_(backend_->report().machine),
      follower_(parts.follower ? parts.follower(*model_, *backend_) : nullptr),
      shared_(takePart()),
      sharedPatience_s_(parts.sharedPatience_s),
      log_(parts.log),
      bricks_(dynamic_cast<BrickTouch*>(backend_.get())),
      relay_(model_->cloud, backend_->edits(),
             {.followers = {shared_.get(), follower_.get()},
              .rate_Hz = shared_ ? kSharedRelay_Hz : kRelay_Hz,
              .journal = (parts.journal || shared_) && kind_.capabilities().keepsEdits,
              .undo_bytes = parts.undo_bytes}) {
  if (shared_ && !config_.brush) backend_->setBrush(std::nullopt);
  // No file tells a replay the scale, so the configuration must.
  if (config_.join) config_.model.mm_per_unit = model_->scale.mm_per_unit;
}

Session::Session(SessionConfig config, Model model, const SessionParts& parts)
    : Session(std::move(config), std::make_shared<const Model>(std::move(model)), parts) {}

Session::~Session() { relay_.stop(); }

std::unique_ptr<SharedFollower> Session::takePart() {
  if (!model_->share) {
    if (config_.join && config_.brush && !model_->far) throw Error("{}", fixedBecause(config_, *model_));
    return nullptr;
  }
  if (!backend_->edits() || backend_->edits()->mostOffered() == 0)
    throw Error(
        "{}: '{}' is sculpted by others, which {} cannot follow; use another back end, or serve the model with "
        "--read-only",
        config_.backend.name, config_.model.file, config_.backend.name);
  return model_->share(model_->cloud, *backend_);
}

// Points around the hands alone: waits until the server has accepted their edits.
bool Session::settleFar(double patience_s) {
  backend_->finish();  // the edit in progress
  const Stopwatch since;
  while (!model_->far->counts().delivered && !isStopWanted() && since.elapsed_s() < patience_s) {
    model_->far->check();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return model_->far->counts().delivered;
}

bool Session::settleShared(double patience_s, Settling until) {
  if (model_->far) return settleFar(patience_s);
  if (!shared_) return true;
  const Stopwatch since;
  relay_.catchUp();
  // The last message may be older than this call: another hand's strokes may be with the server and not yet here.
  if (until == Settling::all) shared_->askServer();
  SharedCounts counts = shared_->counts();
  const auto isSettled = [&] { return counts.atRest && counts.same; };
  const std::uint64_t inEffectBefore = counts.inEffect;
  const auto goesOnWithoutUs = [&] {
    return until == Settling::known && counts.delivered && counts.inEffect > inEffectBefore &&
           since.elapsed_s() > kOthersBusy_s;
  };
  const auto isOver = [&] { return isSettled() || !counts.fault.empty() || goesOnWithoutUs(); };
  std::vector<Pose> far(backend_->hands());
  // Hands that touch nothing: the changes of others are applied between their answers.
  const Bounds box = boundsOf(model_->cloud);
  constexpr double kFar = 1e3;  // longest sides
  const DVec3 nowhere = model_->cloud.origin + box.center() + DVec3(0, 0, kFar * std::max(box.longestSide(), 1.0));
  for (Pose& pose : far) pose = {.time_s = last_s_, .hip = nowhere, .sculpts = false};
  bool hasAsked = false;
  const auto goesOn = [&] { return !isOver() && !isStopWanted() && since.elapsed_s() < patience_s; };
  do {
    for (; goesOn(); counts = shared_->counts()) {
      backend_->ask(far, 0);
      hasAsked = true;
      relay_.catchUp();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    backend_->finish();
    relay_.catchUp();
    counts = shared_->counts();  // with the changes that took effect meanwhile
  } while (goesOn());
  if (hasAsked)
    for (std::size_t hand = 0; hand < far.size(); ++hand) backend_->resetHand(hand);
  return isSettled();
}

bool Session::deliver(double patience_s, double unheard_s) {
  if (!shared_ && !model_->far) return true;
  backend_->finish();
  relay_.catchUp();
  const auto isDelivered = [&] { return shared_ ? shared_->counts().delivered : model_->far->counts().delivered; };
  const auto isHeard = [&] { return known()->isTrue() && known()->share() > 0; };
  for (const Stopwatch since; !isDelivered();) {
    if (isStopWanted() || since.elapsed_s() >= patience_s || (since.elapsed_s() >= unheard_s && !isHeard())) {
      if (log_)
        log_->say("'{}': the server has not confirmed all strokes of this hand, which may be lost", config_.model.file);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

std::optional<PlayCounts> Session::playCounts() const {
  if (!stream_ || !stream_->player) return std::nullopt;
  return stream_->player->counts();
}

std::optional<PlayedView> Session::playedView() const {
  if (!stream_ || !stream_->player) return std::nullopt;
  return stream_->player->view();
}

std::shared_ptr<PlayedStream> Session::releaseStream(double time_s) {
  if (!player()) return nullptr;
  backend_->finish();
  player()->hold(time_s);
  return std::make_shared<PlayedStream>(std::exchange(*stream_, {}));
}

void Session::setBrush(const std::optional<BrushConfig>& brush) {
  SessionConfig next = config_;
  next.brush = brush;
  next = checked(std::move(next), kind_);
  std::optional<BrushOptions> options;
  if (brush) options = brushOptions(*brush, model_->scale);
  backend_->setBrush(options);
  config_ = std::move(next);
}

void Session::setFeel(const SurfaceConfig& surface, const ForceOptions& force, const std::string& method) {
  SessionConfig next = config_;
  next.surface = surface;
  next.force = force;
  next.backend.method = method;
  next = checked(std::move(next), kind_);
  if (next.surface != config_.surface || next.backend != config_.backend)
    backend_->setContact(next.surface.kind, next.surface.friction, kind_.methodOf(next.backend));
  config_ = std::move(next);
}

void Session::setParameter(std::string_view name, double value) {
  if (!simulation()) throw Error("{}: the model is not simulated", name);
  simulation()->set(name, value);
  palpate::setParameter(*config_.matter, name, value);
}

void Session::record(const std::string& file, const OpenHand& hand, RecordingFault onFault, const RunOptions& run) {
  require(Action::record, file);
  if (!journal()) throw Error("{}: a session without a journal cannot be recorded; its end would not be known", file);
  SessionConfig config = config_;
  config.realtime = config.realtime || run.realtime;
  if (run.rate_Hz > 0) config.rate_Hz = run.rate_Hz;
  recording_ = std::make_unique<SessionRecording>(file,
                                                  RecordedSession{.config = config,
                                                                  .points = model_->cloud.size(),
                                                                  .checksum = checksumOf(*model_),
                                                                  .machine = machine_,
                                                                  .palpate = PALPATE_VERSION,
                                                                  .limits = hand.device->limits(),
                                                                  .map = hand.map,
                                                                  .passivity = hand.passivity},
                                                  backend_->edits(), std::move(onFault));
  relay_.setLog(&recording_->writer());
}

std::unique_ptr<SessionRecording> Session::releaseRecording() {
  relay_.setLog(nullptr);
  return std::exchange(recording_, nullptr);
}

void Session::endRecording() {
  const std::unique_ptr<SessionRecording> ended = releaseRecording();
  if (ended) ended->finish(checksumOf(model_->cloud.origin, journal()->points()));
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
    ForceLaw law(config_.force, model_->scale);
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
  bricks_->awaitAt(options.begin_s - kBefore_s, hips, sharedPatience_s_);
  model_->far->check();
}

const InformationAge* Session::known() const {
  if (shared_) return &shared_->known();
  return model_->far ? &model_->far->known() : nullptr;
}

ServoResult Session::run(std::span<const OpenHand> hands, const RunOptions& options) {
  const bool realtime = config_.realtime || options.realtime;
  if (bricks_ && model_->far->source().moves() && !realtime)
    throw Error("'{}' moves in real time; join it with --realtime", config_.model.file);
  backend_->begin(realtime, springs(hands));
  std::vector<SessionHand> touching;
  for (const OpenHand& hand : hands)
    touching.push_back({.device = *hand.device,
                        .law = ForceLaw(config_.force, model_->scale),
                        .options = {.map = hand.map, .passivity = hand.passivity}});
  if (!touching.empty()) touching.front().law.setCustom(options.law);
  const double rate_Hz = options.rate_Hz > 0 ? options.rate_Hz : config_.rate_Hz;
  ToldHands told(shared_.get(), presence(), touching.size(), config_.brush.has_value());
  Recorders recorders({recording_.get(), options.recorder, &told});
  if (!options.endless) settleShared(sharedPatience_s_);  // takes in the edits made before this hand joined
  if (bricks_) awaitPoints(hands, options);
  const JobStopScope whole(JobStopScope::whole());  // no tick is cut short
  ServoLoop loop(options.query ? *options.query : *backend_, touching,
                 {.rate_Hz = rate_Hz,
                  .duration_s = durationOf(hands) + 1 / rate_Hz,  // the path's end is a tick too
                  .begin_s = options.begin_s,
                  .endless = options.endless,
                  .realtime = realtime,
                  .clock = options.clock,
                  .stop = options.stop ? options.stop : jobStop.flag,
                  .forcesOn = options.forcesOn,
                  .known = known(),
                  .recorder = &recorders});
  if (options.endless) return loop.run();  // the thread that displays the session takes the edits
  const TickObserver relays = relay_.begin(rate_Hz, realtime);
  const auto run = [&] {
    if (!options.observer) return loop.run(relays);
    return loop.run([&](const TraceRow& row) {
      if (relays) relays(row);
      options.observer(row);
    });
  };
  ServoResult result = run();
  if (!result.trace().rows.empty()) last_s_ = result.trace().rows.back().time_s;
  return result;
}

void Session::finish() {
  if (model_->far) model_->far->check();
  backend_->finish();
  relay_.finish();
  settleShared(sharedPatience_s_);
}

Abilities Session::abilities() const {
  return Abilities(modelKindOf(config_, *model_, isMoved_), kind_.capabilities(), kind_.name());
}

void Session::require(Action action, std::string_view what) const {
  const Abilities can = abilities();
  if (!can.allow(action)) throw Error("{}: {}", what, can.refusal(action));
}

UndoneStrokes Session::undo(std::size_t strokes, std::size_t redo) {
  if (ShapeStrokes* const shape = backend_->shapeStrokes()) return undoStrokes(*shape, strokes, redo);
  require(Action::undo, "undo");
  if (!journal()) throw Error("a session without a journal has no strokes to undo");
  return undoStrokes(
      *backend_->edits(), *relay_.journal(), [this] { relay_.catchUp(); }, strokes, redo);
}

SculptedCloud Session::sculpted() const {
  if (const Journal* journal = relay_.journal(); journal && !config_.moves() && !isMoved_)
    return {editedCloud(model_->cloud, journal->points()), changedPoints(model_->cloud, journal->points())};
  SculptedCloud sculpted{.cloud = model_->cloud};
  sculpted.edited = backend_->readBack(sculpted.cloud);
  return sculpted;
}

}  // namespace palpate
