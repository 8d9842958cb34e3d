#include "haptics/session/live_session.hpp"

#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/io/saving.hpp"
#include "engine/motion/depth_player.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/session/devices.hpp"

namespace palpate {

namespace {

constexpr double kParked = 3;  // distance of a lifted stylus from the middle of the model, in longest sides

WorkspaceMap mapFor(const Model& model, const Bounds& bounds) {
  return {.scale = model.scale.toUnits(1), .offset = model.cloud.origin + bounds.center()};
}

DVec3 parkingPlace(const Model& model, const Bounds& bounds) {
  return model.cloud.origin + bounds.center() + DVec3(0, kParked * std::max(bounds.longestSide(), 1e-3), 0);
}

bool canBeSculpted(const SessionConfig& config, const Model& model) {
  return Abilities(modelKindOf(config, model)).allow(Action::sculpt);
}

// A model at rest is built with a brush, so that later brushes are possible. A soft body accepts one at any time.
SessionConfig withBrush(SessionConfig config, const Model& model) {
  config.realtime = true;
  if (config.join && !canBeSculpted(config, model)) config.brush.reset();
  if (!canBeSculpted(config, model) || config.matter) return config;
  BrushConfig brush = config.brush.value_or(BrushConfig{.keepsDensity = !config.join});
  brush.kind = BrushKind::push;
  config.brush = brush;
  return config;
}

Model withPoints(Model model, const std::string& file) {
  requirePoints(model, file);
  return model;
}

SessionParts withJournal(SessionParts parts) {
  parts.journal = parts.paintable = true;
  return parts;
}

}  // namespace

void requirePoints(const Model& model, const std::string& file) {
  if (model.cloud.empty()) throw FileError(file, "contains no points; there is nothing to touch");
}

LiveSession::LiveSession(const SessionConfig& config, Model model, SessionParts parts, const LiveOptions& options)
    : session_{withBrush(config, model), withPoints(std::move(model), config.model.file),
               withJournal(std::move(parts))},
      options_(options),
      bounds_(boundsOf(this->model().cloud)),
      journal_(session_.journal()),
      stylus_(mapFor(this->model(), bounds_), parkingPlace(this->model(), bounds_)),
      map_(options.device ? mapInto(options.deviceFacts, this->model()) : mapFor(this->model(), bounds_)),
      seen_(1 / config.rate_Hz) {
  if (DepthPlayer* const player = session_.player()) held_ = player->isPaused();
  if (!config.matter && canBeSculpted(config, this->model()) &&
      (!config.brush || config.brush->kind != BrushKind::push))
    session_.setBrush(config.brush);
  if (!options.unsavedIn.empty()) keepUnsaved(config);
  if (options.left) goOnWith(*options.left);
  start();
}

// Only for files: a model from another source cannot be read again.
void LiveSession::keepUnsaved(const SessionConfig& config) {
  if (modelKindOf(config, model()) != ModelKind::cloud || isRosModel(file())) return;
  unsaved_.emplace(options_.unsavedIn, model());
  unsaved_->describe({.config = config, .machine = machine(), .palpate = PALPATE_VERSION});
}

void LiveSession::goOnWith(const LeftStrokes& left) {
  followAgain(*journal_, left.edits);
  if (unsaved_) unsaved_->adopt(left);
  const std::vector<PointState> before = statesOf(model().cloud);
  std::vector<PointChange> changes;
  for (const PointState& state : journal_->points()) {
    const std::uint32_t id = state.number();
    const PointState from = id < before.size() ? before[id] : PointState{.id = id | PointState::kGone, .parent = id};
    if (!(from == state)) changes.push_back({from, state});
  }
  session_.backend().edits()->change(changes);
  takeIn();
}

LiveSession::~LiveSession() {
  stop();
  if (saving_.running.valid()) saving_.running.wait();
  try {
    if (!servo_.lost) session_.deliver();
  } catch (const std::exception&) {  // nothing to report: the session is over
  }
}

OpenHand LiveSession::hand() {
  if (playing_) return {.device = playing_->device.get(), .map = playing_->map};
  if (options_.device) return {.device = options_.device.get(), .map = map_};
  return {.device = &stylus_, .map = map_};
}

void LiveSession::start() {
  servo_.stop = false;
  servo_.ended = false;
  if (options_.clock) options_.clock->hold();
  servo_.thread = std::jthread([this] {
    try {
      const OpenHand touching = hand();
      const ServoResult result = session_.run({&touching, 1}, {.begin_s = servo_.next_s,
                                                               .endless = true,
                                                               .clock = options_.clock.get(),
                                                               .stop = &servo_.stop,
                                                               .forcesOn = &servo_.forcesOn,
                                                               .recorder = &seen_.feed});
      if (result.deviceFailed) servo_.fault = result.fault;
      if (result.queryLost) servo_.fault = machine() + " was lost; earlier results are kept";
    } catch (const std::exception& error) {
      servo_.fault = error.what();
    }
    servo_.ended = true;
    if (options_.clock) options_.clock->leave();
  });
}

// Releases the clock once only: another session may already use it.
void LiveSession::stop() {
  if (!servo_.thread.joinable()) return;
  servo_.stop = true;
  if (options_.clock) options_.clock->letGo();
  servo_.thread.join();
}

void LiveSession::park() {
  stop();
  finishTicks();
}

void LiveSession::goOn() {
  if (!servo_.lost) start();
}

void LiveSession::finishTicks() {
  takeIn();
  seen_.history.interrupt();
  if (!seen_.history.rows().empty()) servo_.next_s = seen_.history.rows().back().time_s + 1 / config().rate_Hz;
  if (servo_.lost) return;
  session_.backend().finish();
  takeIn();
}

void LiveSession::takeIn() {
  seen_.rows.clear();
  seen_.feed.take(seen_.rows);
  seen_.history.add(seen_.rows);
  session_.relay().catchUp();
  const EditBatch& fresh = session_.relay().batch();
  seen_.batch.points.insert(seen_.batch.points.end(), fresh.points.begin(), fresh.points.end());
  seen_.edits += fresh.points.size();
  if (unsaved_) unsaved_->follow(fresh, *journal_, isChanged());
}

std::optional<std::string> LiveSession::follow() {
  if (servo_.lost) return std::nullopt;
  std::string failure;
  try {
    takeIn();
    const auto& rows = seen_.history.rows();
    if (playing_ && !rows.empty() && rows.back().time_s > playing_->end_s) endPlaying();
    if (servo_.ended && !servo_.stop) failure = servo_.fault.empty() ? "the servo thread has ended" : servo_.fault;
  } catch (const std::exception& error) {
    failure = error.what();
  }
  if (failure.empty()) return std::nullopt;
  servo_.lost = true;
  stop();
  return failure;
}

std::optional<std::string> LiveSession::tickUntil(double clock_s) {
  // Short steps: the back end stores the edits of a limited number of ticks until they are taken.
  constexpr double kTaken_s = 0.005;
  std::optional<std::string> failure;
  while (!servo_.lost && !failure && servo_.clock_s < clock_s) {
    servo_.clock_s = std::min(servo_.clock_s + kTaken_s, clock_s);
    options_.clock->goOnTo(servo_.clock_s);
    failure = follow();
  }
  return failure;
}

void LiveSession::setBrush(const std::optional<BrushConfig>& brush) {
  if (brush == config().brush || servo_.lost) return;
  if (config().join) session_.require(Action::sculpt, file());
  endRecording();
  between([&] { session_.setBrush(brush); });
}

std::optional<bool> LiveSession::holdFrames() {
  DepthPlayer* const player = session_.player();
  if (!player) return std::nullopt;
  between([&] { player->isPaused() ? player->play(servo_.next_s) : player->pause(servo_.next_s); });
  return held_ = player->isPaused();
}

Model LiveSession::handOn() {
  if (servo_.lost) throw Error("{}: the session has ended; its points can be saved", file());
  endRecording();
  return between([&] {
    const Model& had = model();
    std::shared_ptr<PlayedStream> stream = session_.releaseStream(servo_.next_s);
    if (!stream && isHeldStill()) stream = std::make_shared<PlayedStream>(std::exchange(*had.stream, {}));
    // Scale and spacing stay, so that the surface feels the same.
    return Model{.cloud = session_.sculpted().cloud,
                 .scale = had.scale,
                 .spacing = had.spacing,
                 .wideSpacing = had.wideSpacing,
                 .noise = had.noise,
                 .upright = had.upright,
                 .shown = had.shown,
                 .stream = std::move(stream),
                 .cameras = had.cameras};
  });
}

std::shared_ptr<PlayedStream> LiveSession::releaseStream() {
  if (!session_.player()) return nullptr;
  return between([&] { return session_.releaseStream(servo_.next_s); });
}

void LiveSession::stepFrame() {
  if (DepthPlayer* const player = session_.player()) between([&] { player->step(); });
}

void LiveSession::setFeel(const SurfaceConfig& surface, const ForceOptions& force, const std::string& method) {
  if (servo_.lost) return;
  if (surface == config().surface && force == config().force && method == config().backend.method) return;
  endRecording();
  between([&] { session_.setFeel(surface, force, method); });
}

void LiveSession::setParameter(std::string_view name, double value) {
  if (servo_.lost) return;
  endRecording();
  between([&] { session_.setParameter(name, value); });
}

bool LiveSession::undoStrokes(std::size_t undo, std::size_t redo) {
  if (servo_.lost) return false;
  session_.require(Action::undo, "undo");
  endRecording();
  return between([&] {
    ShapeStrokes* const shape = session_.backend().shapeStrokes();
    const UndoneStrokes strokes = shape ? palpate::undoStrokes(*shape, undo, redo)
                                        : palpate::undoStrokes(
                                              *session_.backend().edits(), *journal_, [&] { takeIn(); }, undo, redo);
    return strokes.undone + strokes.redone > 0;
  });
}

bool LiveSession::redo() { return strokes().redoable > 0 && undoStrokes(0, 1); }

StrokeCounts LiveSession::strokes() const {
  if (const ShapeStrokes* const shape = session_.backend().shapeStrokes()) return shape->counts();
  return {.strokes = journal_->strokes(),
          .dropped = journal_->dropped(),
          .undoable = journal_->undoable(),
          .redoable = journal_->redoable(),
          .version = journal_->version()};
}

void LiveSession::save(const std::string& file) {
  if (isSaving()) throw Error("{}: the last save is still being written", file);
  // The journal does not contain the points of a model that moves.
  std::optional<PointCloud> present;
  const auto look = [&] {
    if (config().moves()) present = session_.sculpted().cloud;
  };
  servo_.lost ? look() : between(look);
  saving_.version = strokes().version;
  std::vector<PointState> points(journal_->points().begin(), journal_->points().end());
  saving_.running =
      std::async(std::launch::async, [this, file, points = std::move(points), present = std::move(present)] {
        try {
          std::error_code isNone;
          if (unsaved_ && std::filesystem::equivalent(file, this->file(), isNone)) unsaved_->keepModel();
          const std::filesystem::path kept = saveKeeping(file, present ? *present : editedCloud(model().cloud, points));
          return Saved{file, kept.string(), {}};
        } catch (const std::exception& error) {
          return Saved{file, {}, error.what()};
        }
      });
}

std::optional<LiveSession::Saved> LiveSession::takeSaved() {
  if (!saving_.running.valid() || saving_.running.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  const Saved saved = saving_.running.get();
  if (saved.failure.empty()) saving_.saved = saving_.version;
  if (unsaved_ && !isChanged()) unsaved_->saved();
  return saved;
}

void LiveSession::setDocument(const std::string& file) {
  if (unsaved_) unsaved_->setDocument(file);
}

void LiveSession::leaveStrokes() {
  if (unsaved_) unsaved_->remove();
}

std::optional<std::string> LiveSession::takeUnsavedFault() { return unsaved_ ? unsaved_->takeFault() : std::nullopt; }

void LiveSession::record(const std::string& log) {
  if (edits() > 0)
    throw Error("{}: a recording begins with the model as its file has it; save it and open the saved file first", log);
  endRecording();
  between([&] {
    session_.record(log, hand());
    // A replay begins with a stylus that has had no contact yet.
    session_.backend().resetHand(0);
    session_.recording()->beginAt(servo_.next_s);
  });
}

void LiveSession::endRecording() {
  if (!isRecording()) return;
  std::unique_ptr<SessionRecording> recording;
  between([&] { recording = session_.releaseRecording(); });
  try {
    recording->finish(checksumOf(model().cloud.origin, journal_->points()));
  } catch (const FileError&) {
    if (recording->takeFault()) throw;
  }
}

std::optional<std::string> LiveSession::takeRecordingFault() {
  return isRecording() ? session_.recording()->takeFault() : std::nullopt;
}

std::vector<std::string> LiveSession::play(const std::string& log) {
  SessionRecord record = readSessionLog(log);
  const RecordedSession recorded = parseHeader(log, record.text);
  if (record.ticks.empty()) throw FileError(log, "contains no complete tick; there is nothing to play");
  std::vector<std::string> lacks = whatIsMissing(record);
  endRecording();
  between([&] {
    session_.backend().resetHand(0);
    for (LoggedTick& tick : record.ticks) tick.time_s += servo_.next_s;
    const double end_s = record.ticks.back().time_s;
    playing_ = Playing{.device = std::make_unique<ReplayDevice>(std::move(record.ticks), recorded.limits),
                       .map = recorded.map,
                       .end_s = end_s};
  });
  return lacks;
}

void LiveSession::endPlaying() {
  if (!playing_) return;
  between([&] {
    session_.backend().resetHand(0);
    playing_.reset();
  });
}

}  // namespace palpate
