#include "haptics/session/session.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/matter/matter_parameters.hpp"
#include "haptics/session/stream_model.hpp"

namespace palpate {

namespace {

SessionConfig checked(SessionConfig config, const BackendKind& kind) {
  validate(config);
  kind.check(config);
  return config;
}

std::unique_ptr<TouchBackend> makeBackend(const SessionConfig& config, const Model& model,
                                          const SurfaceOptions& surface, const SessionParts& parts, CloudSource* source,
                                          const std::optional<FusedStream>& fusion) {
  std::optional<BrushOptions> brush;
  if (config.brush) brush = brushOptions(*config.brush, model.scale);
  // The tool is the first hand's.
  std::vector<ToolShape> tools{toolShape(config.tool, model.scale)};
  tools.resize(std::max<std::size_t>(1, config.hands.size()));
  return parts.backend.make({.model = model,
                             .config = config,
                             .surface = surface,
                             .brush = brush,
                             .paintable = parts.paintable,
                             .tools = std::move(tools),
                             .threads = parts.threads,
                             .source = source,
                             .fusion = source ? std::nullopt : fusion});
}

/// Two of them, in this order; either may be null.
class Recorders final : public TickRecorder {
 public:
  Recorders(TickRecorder* first, TickRecorder* second) : all_{first, second} {}
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override {
    for (TickRecorder* each : all_)
      if (each) each->ticked(row, device);
  }
  void tickedToo(std::size_t hand, const TraceRow& row) noexcept override {
    for (TickRecorder* each : all_)
      if (each) each->tickedToo(hand, row);
  }

 private:
  std::array<TickRecorder*, 2> all_;
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
      follower_(parts.follower ? parts.follower(*model_, *backend_) : nullptr),
      relay_(model_->cloud, *backend_,
             {.follower = follower_.get(),
              .journal = parts.journal && backend_->keepsEdits(),
              .undo_bytes = parts.undo_bytes}) {
  // No file says it to whoever runs a record again.
  if (config_.join) config_.model.mm_per_unit = model_->scale.mm_per_unit;
}

Session::Session(SessionConfig config, Model model, const SessionParts& parts)
    : Session(std::move(config), std::make_shared<const Model>(std::move(model)), parts) {}

Session::~Session() { relay_.stop(); }

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
  config_ = checked(std::move(next), kind_);
  std::optional<BrushOptions> options;
  if (brush) options = brushOptions(*brush, model_->scale);
  backend_->setBrush(options);
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
  if (!simulation()) throw Error("{}: the model does not move by itself", name);
  simulation()->set(name, value);
  palpate::setParameter(*config_.matter, name, value);
}

void Session::record(const std::string& file, const OpenHand& hand, RecordingFault onFault, const RunOptions& run) {
  if (config_.stream && config_.stream->live)
    throw Error("{}: a session with a live camera cannot be recorded: its frames do not come again", file);
  if (model_->stream && !config_.stream)
    throw Error("{}: what a camera has seen is in no file yet; save the points and open what was saved", file);
  if (isMoved_) throw Error("{}: frames that a program brings do not come again, and are not recorded", file);
  if (!journal()) throw Error("{}: a session without a journal cannot be recorded; its end would not be known", file);
  SessionConfig config = config_;
  config.realtime = config.realtime || run.realtime;
  if (run.rate_Hz > 0) config.rate_Hz = run.rate_Hz;
  recording_ = std::make_unique<SessionRecording>(file,
                                                  RecordedSession{.config = config,
                                                                  .points = model_->cloud.size(),
                                                                  .checksum = checksumOf(*model_),
                                                                  .machine = backend_->machine(),
                                                                  .palpate = PALPATE_VERSION,
                                                                  .limits = hand.device->limits(),
                                                                  .map = hand.map,
                                                                  .passivity = hand.passivity},
                                                  *backend_, std::move(onFault));
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

// As each hand feels it, with what its device bears.
void Session::setSprings(std::span<const OpenHand> hands) {
  std::vector<HandSpring> springs;
  for (const OpenHand& hand : hands) {
    ForceLaw law(config_.force, model_->scale);
    const DeviceLimits limits = hand.device->limits();
    law.limitTo(limits.peakForce_N, limits.mostStiffness_N_per_mm);
    springs.push_back(springOf(law));
  }
  backend_->setSprings(springs);
}

ServoResult Session::run(std::span<const OpenHand> hands, const RunOptions& options) {
  setSprings(hands);
  const bool realtime = config_.realtime || options.realtime;
  backend_->setRealtime(realtime);
  std::vector<SessionHand> touching;
  for (const OpenHand& hand : hands)
    touching.push_back({.device = *hand.device,
                        .law = ForceLaw(config_.force, model_->scale),
                        .options = {.map = hand.map, .passivity = hand.passivity}});
  if (!touching.empty()) touching.front().law.setCustom(options.law);
  const double rate_Hz = options.rate_Hz > 0 ? options.rate_Hz : config_.rate_Hz;
  Recorders recorders(recording_.get(), options.recorder);
  ServoLoop loop(options.query ? *options.query : *backend_, touching,
                 {.rate_Hz = rate_Hz,
                  .duration_s = durationOf(hands) + 1 / rate_Hz,  // the path's end is a tick too
                  .begin_s = options.begin_s,
                  .endless = options.endless,
                  .realtime = realtime,
                  .clock = options.clock,
                  .stop = options.stop,
                  .forcesOn = options.forcesOn,
                  .recorder = &recorders});
  if (options.endless) return loop.run();  // whoever shows it takes the edits in
  const TickObserver relays = relay_.begin(rate_Hz, realtime);
  if (!options.observer) return loop.run(relays);
  return loop.run([&](const TraceRow& row) {
    if (relays) relays(row);
    options.observer(row);
  });
}

void Session::finish() {
  backend_->finish();
  relay_.finish();
}

UndoneStrokes Session::undo(std::size_t strokes, std::size_t redo) {
  if (ShapeStrokes* const shape = backend_->shapeStrokes()) return undoStrokes(*shape, strokes, redo);
  if (!journal()) throw Error("a session without a journal has no strokes to undo");
  return undoStrokes(
      *backend_, *relay_.journal(), [this] { relay_.catchUp(); }, strokes, redo);
}

SculptedCloud Session::sculpted() const {
  if (const Journal* journal = relay_.journal(); journal && !config_.moves() && !isMoved_)
    return {editedCloud(model_->cloud, journal->points()), changedPoints(model_->cloud, journal->points())};
  SculptedCloud sculpted{.cloud = model_->cloud};
  sculpted.edited = backend_->readBack(sculpted.cloud);
  return sculpted;
}

}  // namespace palpate
