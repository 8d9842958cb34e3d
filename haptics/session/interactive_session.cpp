#include "haptics/session/interactive_session.hpp"

#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/motion/depth_player.hpp"
#include "haptics/crash_stop.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/session/devices.hpp"

namespace palpate {

namespace {

constexpr double kParked = 3;  // distance of a lifted stylus from the middle of the model, in longest sides

WorkspaceMap mapFor(const Model& model) {
  return {.scale = model.scale.toUnits(1), .offset = model.cloud.origin + model.shownBounds().center()};
}

DVec3 parkingPlace(const Model& model) {
  const Bounds bounds = model.shownBounds();
  return model.cloud.origin + bounds.center() + DVec3(0, kParked * std::max(bounds.longestSide(), 1e-3), 0);
}

bool canBeSculpted(const SessionConfig& config, const Model& model) {
  return Abilities(modelKindOf(config, model)).allow(Action::sculpt);
}

// A model at rest is built with a brush, so that later brushes are possible. A soft body accepts one at any time.
SessionConfig withBrush(SessionConfig config, const Model& model) {
  config.realtime = true;
  if (config.model.join && !canBeSculpted(config, model)) config.brush.reset();
  if (!canBeSculpted(config, model) || config.model.matter) return config;
  BrushConfig brush = config.brush.value_or(BrushConfig{.resample = !config.model.join});
  brush.kind = BrushKind::push;
  config.brush = brush;
  return config;
}

Model withPoints(Model model, const std::string& file) {
  requirePoints(model, file);
  return model;
}

}  // namespace

void requirePoints(const Model& model, const std::string& file) {
  if (model.cloud.empty()) throw FileError(file, "contains no points; there is nothing to touch");
}

/// Gives the session its edits.
class InteractiveSession::Follower final : public EditFollower {
 public:
  explicit Follower(InteractiveSession& session) : session_(session) {}
  void catchUp(const EditBatch& batch) override {
    try {
      session_.take(batch);
    } catch (...) {  // reported by takeIn(), so that this follower continues
      session_.takeFailure_ = std::current_exception();
    }
  }

 private:
  InteractiveSession& session_;
};

InteractiveSession::InteractiveSession(const SessionConfig& config, Model model, SessionParts parts,
                                       const InteractiveOptions& options)
    : session_{withBrush(config, model), withPoints(std::move(model), config.model.file),
               [&] {
                 parts.keepsPoints = parts.paintable = true;
                 parts.followers.emplace_back(
                     [this](const Model&, TouchBackend&) { return std::make_unique<Follower>(*this); });
                 return parts;
               }()},
      options_(options),
      bounds_(boundsOf(this->model().cloud)),
      longestSide_(this->model().shownBounds().longestSide()),
      stylus_(mapFor(this->model()), parkingPlace(this->model()),
              {.tick_s = 1 / config.rate_Hz,
               .countsTicks = !config.moves() && !config.model.join,
               .catchesUp = !options.clock}),
      map_(options.device ? mapInto(options.deviceFacts, this->model()) : mapFor(this->model())) {
  if (const DepthPlayer* const frames = session_.player()) held_ = frames->isPaused();
  if (!config.model.matter && canBeSculpted(config, this->model()) && config.brush != this->config().brush)
    session_.setBrush(config.brush);
  if (!options.unsavedIn.empty()) keepUnsaved(config);
  if (options.attributes && session_.abilities().allow(Action::select)) session_.followAgain(*options.attributes);
  if (options.left) goOnWith(*options.left);
  session_.start({hand()}, {.clock = options.clock, .forcesOn = &forcesOn_});
}

// Only for files: a model from another source cannot be read again.
void InteractiveSession::keepUnsaved(const SessionConfig& config) {
  if (modelKindOf(config, model()) != ModelKind::cloud || isRosModel(file())) return;
  unsaved_.emplace(options_.unsavedIn, model());
  unsaved_->describe({.config = config, .machine = session_.machine(), .palpate = PALPATE_VERSION});
}

void InteractiveSession::goOnWith(const LeftStrokes& left) {
  if (unsaved_) unsaved_->adopt(left);
  session_.followAgain(left.edits);
  // The file on disk has what was undone, or lacks what the history does not count: what a log began with after a save.
  constexpr std::uint64_t kNever = ~std::uint64_t{0};
  const bool isCounted = session_.strokes().version != 0 || left.since.made == 0;
  if (left.since.undone > 0 || !isCounted) saving_.saved = kNever;
  const std::size_t depth = session_.strokes().undoCount;
  since_.before = {.made = left.since.made - std::min(left.since.made, depth), .undone = left.since.undone};
}

StrokesSince InteractiveSession::strokesSince() {
  const std::size_t depth = session_.strokes().undoCount;
  if (!isUnsaved()) since_ = {.before = {}, .saved = depth, .low = depth};
  since_.low = std::min(since_.low, depth);
  return {.made = since_.before.made + depth - since_.low, .undone = since_.before.undone + since_.saved - since_.low};
}

InteractiveSession::~InteractiveSession() {
  session_.stop();
  if (saving_.running.valid()) saving_.running.wait();
  try {
    if (!failed_) session_.deliver();
  } catch (const std::exception&) {  // nothing to report: the session is over
  }
}

OpenHand InteractiveSession::hand() {
  if (playing_) return {.device = playing_->device.get(), .map = playing_->map};
  if (options_.device) return {.device = options_.device.get(), .map = map_};
  return {.device = &stylus_, .map = map_};
}

void InteractiveSession::take(const EditBatch& batch) {
  batch_.points.insert(batch_.points.end(), batch.points.begin(), batch.points.end());
  batch_.attributes.insert(batch_.attributes.end(), batch.attributes.begin(), batch.attributes.end());
  edits_ += batch.points.size();
  attributeChanges_ += batch.attributes.size();
  if (unsaved_) unsaved_->follow(batch, history().points(), attributes(), isUnsaved(), strokesSince());
}

void InteractiveSession::takeIn() {
  rows_.clear();
  if (session_.live()) session_.live()->take(rows_);
  recentTicks_.add(rows_);
  session_.catchUp();
  if (takeFailure_) std::rethrow_exception(std::exchange(takeFailure_, nullptr));
}

std::optional<std::string> InteractiveSession::follow() {
  if (failed_) return std::nullopt;
  std::string failure;
  try {
    const bool hasEnded = session_.live()->hasEnded();
    takeIn();
    const auto& rows = recentTicks_.rows();
    if (playing_ && !rows.empty() && rows.back().time_s > playing_->end_s) endPlaying();
    if (hasEnded) failure = session_.live()->fault();
  } catch (const std::exception& error) {
    failure = error.what();
  }
  if (failure.empty()) return std::nullopt;
  failed_ = true;
  session_.stop();
  return failure;
}

std::optional<std::string> InteractiveSession::tickUntil(double clock_s) {
  // Short steps: the back end stores the edits of a limited number of ticks until they are taken.
  constexpr double kTaken_s = 0.005;
  std::optional<std::string> failure;
  while (!failed_ && !failure && clock_s_ < clock_s) {
    clock_s_ = std::min(clock_s_ + kTaken_s, clock_s);
    options_.clock->goOnTo(clock_s_);
    failure = follow();
  }
  return failure;
}

StrokeOptions InteractiveSession::strokeOptions(double press_mm) const {
  StrokeOptions options{.tick_s = 1 / config().rate_Hz,
                        .origin = model().cloud.origin,
                        .unitsPer_mm = model().scale.toUnits(1),
                        .inward = model().scale.toUnits(press_mm)};
  if (const auto& brush = config().brush) {
    options.inward += model().scale.toUnits(brush->yieldDepth_mm);
    if (brushHas(brush->kind, shared::kHoldsPoints)) options.holdsFrom = model().scale.toUnits(brush->yieldDepth_mm);
  }
  return options;
}

void InteractiveSession::press(PointerStroke stroke) {
  if (!isDrawing() && !failed_ && !playing_ && !options_.device) stroke_ = std::move(stroke);
}

void InteractiveSession::drawUntil(double known_s) {
  while (stroke_ && stylus_.canDraw() && stroke_->isKnown(known_s)) {
    if (const auto pose = stroke_->next()) {
      stylus_.draw(*pose);
      session_.live()->wake();
    }
    if (stroke_->isOver()) stroke_.reset();
  }
  if (failed_) dropStroke();
}

void InteractiveSession::dropStroke() {
  stroke_.reset();
  stylus_.dropStroke();
}

bool InteractiveSession::cancelStroke() {
  if (failed_ || playing_) return false;
  const bool isDrawn = isDrawing();
  stroke_.reset();
  const auto rest = [this] { stylus_.giveUpStroke(); };
  if (session_.abilities().allow(Action::undo)) return session_.cancelStroke(rest) || isDrawn;
  rest();
  return isDrawn;
}

void InteractiveSession::setDevice(std::shared_ptr<TurnedDevice> device, const HapticDeviceFacts& facts) {
  if (failed_ && !hasLostDevice()) return;
  const auto change = [&] {
    session_.backend().resetHand(0);
    playing_.reset();
    dropStroke();
    options_.device = std::move(device);
    options_.deviceFacts = facts;
    map_ = options_.device ? mapInto(facts, model()) : mapFor(model());
    session_.live()->setHands({hand()});
  };
  if (!failed_) {
    endRecording();
    return session_.restarted(change);
  }
  session_.backend().finish();
  session_.catchUp();
  endRecording();
  change();
  failed_ = false;
  session_.restart();
}

void InteractiveSession::setBrush(const std::optional<BrushConfig>& brush) {
  if (brush == config().brush || failed_) return;
  if (config().model.join) session_.require(Action::sculpt, file());
  session_.setBrush(brush);
}

void InteractiveSession::setContact(const SurfaceConfig& surface, const ForceOptions& force,
                                    const std::string& method) {
  if (failed_) return;
  if (surface == config().surface && force == config().force && method == config().backend.method) return;
  session_.setContact(surface, force, method);
}

void InteractiveSession::setParameter(std::string_view name, double value) {
  if (!failed_) session_.setParameter(name, value);
}

std::uint32_t InteractiveSession::fieldNamed(std::string_view name, ScalarType type) {
  if (failed_) throw Error("{}: the session has ended", name);
  return session_.fieldNamed(name, type);
}

bool InteractiveSession::undoStrokes(std::size_t undo, std::size_t redo) {
  if (failed_) return false;
  session_.require(Action::undo, "undo");
  undone_ = session_.undo(undo, redo);
  return undone_.undone + undone_.redone > 0;
}

std::optional<bool> InteractiveSession::holdFrames() {
  const DepthPlayer* const frames = session_.player();
  if (!frames) return std::nullopt;
  session_.setFrames(frames->isPaused() ? Session::Frames::play : Session::Frames::pause);
  return held_ = frames->isPaused();
}

void InteractiveSession::stepFrame() { session_.setFrames(Session::Frames::step); }

bool InteractiveSession::isUnsaved() const { return isChanged() || attributes().hasMasks(); }

InteractiveSession::HandedOn InteractiveSession::handOn() {
  if (failed_) throw Error("{}: the session has ended; its points can be saved", file());
  endRecording();
  return session_.between([&] {
    const Model& had = model();
    std::shared_ptr<PlayedStream> stream = session_.releaseStream(session_.next_s());
    if (!stream && isHeldStill()) stream = std::make_shared<PlayedStream>(std::exchange(*had.stream(), {}));
    EditBatch past = session_.attributeHistory();
    for (AttributeChange& change : past.attributes) change = renumbered(change, history().points());
    // Scale and spacing stay, so that the surface feels the same.
    Model next{.cloud = past.empty() ? session_.sculpted().cloud : editedCloud(had.cloud, history().points()),
               .scale = had.scale,
               .spacing = had.spacing,
               .wideSpacing = had.wideSpacing,
               .noise = had.noise,
               .upright = had.upright,
               .shown = had.shown,
               .cameras = had.cameras,
               .source = {}};
    if (stream) next.source = CameraPoints{.stream = std::move(stream)};
    return HandedOn{std::move(next), std::make_shared<const EditBatch>(std::move(past))};
  });
}

std::shared_ptr<PlayedStream> InteractiveSession::releaseStream() {
  if (!session_.player()) return nullptr;
  return session_.between([&] { return session_.releaseStream(session_.next_s()); });
}

void InteractiveSession::setForces(bool on) {
  if (on) CrashStop::resume(&forcesOn_);
  forcesOn_ = on;
}

void InteractiveSession::save(const std::string& file) {
  if (isSaving()) throw Error("{}: the last save is still being written", file);
  session_.require(Action::save, file);
  // The history does not contain the points of a model that moves, nor all of one that is elsewhere.
  std::optional<SculptedCloud> present;
  const auto look = [&] {
    if (config().moves() || session_.far()) present = session_.sculpted();
  };
  failed_ ? look() : session_.between(look);
  saving_.version = session_.strokes().version;
  saving_.depth = session_.strokes().undoCount;
  std::vector<PointState> points(history().points().begin(), history().points().end());
  std::vector<Field> fields = attributes().fields();
  saving_.running =
      std::async(std::launch::async, [this, file, loaded = this->file(), points = std::move(points),
                                      fields = std::move(fields), present = std::move(present)]() mutable {
        try {
          // The strokes since are strokes on the model's file, wherever it is saved.
          std::error_code isNone;
          if (unsaved_ && std::filesystem::is_regular_file(loaded, isNone)) unsaved_->keepModel();
          std::string remark = present ? present->remark : std::string(), lost;
          const auto add = [&](const std::string& more) {
            if (!more.empty()) remark += (remark.empty() ? "" : "; ") + more;
          };
          PointCloud cloud = present ? std::move(present->cloud) : editedCloud(model().cloud, points, fields);
          if (cloud.size() < model().cloud.size() &&
              keepPose(cloud.storedAs.comments, model().scale.toMm(1), model().upright.up) &&
              !cloudFormats().toWrite(file).hasComments)
            add("this format cannot hold the up axis and the touch scale of the whole model");
          const std::filesystem::path kept =
              saveKeeping(file, std::move(cloud), {.own = &saving_.own, .like = loaded, .notKept = &lost});
          add(lost);
          if (const auto answer = session_.saveAtServer()) add(inWords(*answer));
          return Saved{file, kept.string(), {}, remark};
        } catch (const std::exception& error) {
          return Saved{file, {}, error.what(), {}};
        }
      });
}

std::optional<InteractiveSession::Saved> InteractiveSession::takeSaved() {
  if (!saving_.running.valid() || saving_.running.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  const Saved saved = saving_.running.get();
  if (saved.failure.empty()) {
    saving_.saved = saving_.version;
    since_ = {.before = {}, .saved = saving_.depth, .low = saving_.depth};
  }
  if (unsaved_ && !isChanged()) unsaved_->saved(history().points(), attributes());
  return saved;
}

void InteractiveSession::setDocument(const std::string& file) {
  if (unsaved_) unsaved_->setDocument(file);
}

void InteractiveSession::leaveStrokes() {
  if (unsaved_) unsaved_->remove();
}

std::optional<std::string> InteractiveSession::takeUnsavedFault() {
  return unsaved_ ? unsaved_->takeFault() : std::nullopt;
}

std::filesystem::path InteractiveSession::record(const std::string& log) {
  if (edits() > 0)
    throw Error("{}: a recording begins with the model as its file has it; save it and open the saved file first", log);
  endRecording();
  session_.record(log, hand());
  return session_.recording()->writer().keptAs();
}

std::optional<std::string> InteractiveSession::takeRecordingFault() {
  return isRecording() ? session_.recording()->takeFault() : std::nullopt;
}

std::vector<std::string> InteractiveSession::play(const std::string& log) {
  SessionRecord record = readSessionLog(log);
  const RecordedSession recorded = parseHeader(log, record.text);
  if (record.ticks.empty()) throw FileError(log, "contains no complete tick; there is nothing to play");
  std::vector<std::string> lacks = whatIsMissing(record);
  endRecording();
  session_.restarted([&] {
    session_.backend().resetHand(0);
    for (LoggedTick& tick : record.ticks) tick.time_s += session_.live()->next_s();
    const double end_s = record.ticks.back().time_s;
    dropStroke();
    playing_ = Playing{.device = std::make_unique<ReplayDevice>(std::move(record.ticks), recorded.limits),
                       .map = recorded.map,
                       .end_s = end_s};
    session_.live()->setHands({hand()});
  });
  return lacks;
}

void InteractiveSession::endPlaying() {
  if (!playing_) return;
  session_.restarted([&] {
    session_.backend().resetHand(0);
    playing_.reset();
    session_.live()->setHands({hand()});
  });
}

}  // namespace palpate
