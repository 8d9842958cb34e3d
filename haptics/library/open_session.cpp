#include "haptics/library/open_session.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/edit/journal.hpp"
#include "haptics/devices/path_device.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/backend_choice.hpp"

namespace palpate::library {

namespace {

std::size_t handsFrom(const pp_session_options& options) {
  if (options.hands > PP_MAX_HANDS) throw UsageError("hands: {} exceed the maximum of {}", options.hands, PP_MAX_HANDS);
  return std::max(1u, options.hands);
}

SessionConfig configFrom(const Subject& subject, const pp_session_options& options) {
  const pp_contact_options contact = optionsFrom(options.contact, "contact");
  SessionConfig config{.model = subject.model, .surface = surfaceFrom(contact), .force = forceFrom(contact)};
  config.model.mm_per_unit = options.mm_per_unit;
  if (options.estimate_normals) config.model.normals = NormalSource::estimate;
  config.matter = subject.scene;
  config.stream = subject.stream;
  if (subject.join) config.join = subject.join->network;
  if (options.tool) config.tool = toolFrom(optionsFrom(options.tool, "tool"));
  config.hands.resize(handsFrom(options));
  config.rate_Hz = options.rate_Hz;
  config.undo.memory_MiB = options.undo_memory_MiB;
  config.backend.name = backendOf(options.backend, {options.gpu, options.vulkan}, hasRealGpu);
  validate(config);
  return config;
}

double budgetFrom(const pp_session_options& options) {
  constexpr double kLongest_us = 1e9;
  if (!(options.budget_us >= 0 && options.budget_us <= kLongest_us))
    throw UsageError("budget_us: {} is not between 0 and {}", options.budget_us, kLongest_us);
  return options.budget_us;
}

// Whether the program leaves the back end to this library.
bool isOpen(const pp_session_options& options) {
  const std::string backend = textOf(options.backend);
  return (backend.empty() || backend == "auto") && textOf(options.gpu).empty() && !options.vulkan;
}

bool hasArrays(const Subject& subject) { return subject.cloud || !subject.clouds.empty(); }

Model modelFrom(const Subject& subject, const SessionConfig& config, const ModelLoading& loading) {
  if (!hasArrays(subject)) return loadModel(config, loading);
  ModelConfig model = config.model;
  PointCloud cloud;
  if (subject.clouds.empty()) {
    cloud = *subject.cloud;
  } else {
    cloud = mergedCloud(subject.clouds, model.normals, loading);
    model.normals = NormalSource::keep;
  }
  if (cloud.empty()) throw UsageError("the cloud contains no points");
  return modelOf(std::move(cloud), model, loading);
}

// Paths begin at 0, but the time of moving points may be later.
Path later(const Path& path, double by_s) {
  std::vector<PathKey> keys(path.keys().begin(), path.keys().end());
  for (PathKey& key : keys) key.t_s += by_s;
  return Path(std::move(keys));
}

}  // namespace

/// Receives all edits.
class OpenSession::Followers final : public EditFollower {
 public:
  explicit Followers(OpenSession& session) : session_(session) {}
  void catchUp(const EditBatch& batch) override {
    session_.edits_ += batch.points.size();
    session_.gpu_.follow(batch);
    session_.queries_.follow(batch);
  }

 private:
  OpenSession& session_;
};

OpenSession::OpenSession(const Subject& subject, const pp_session_options& options, std::shared_ptr<Watch> watch)
    : watch_(std::move(watch)),
      messages_(options.log, options.log_user, *watch_),
      config_(configFrom(subject, options)),
      threads_(options.threads),
      budget_us_(budgetFrom(options)),
      gpu_({options.gpu, options.vulkan}),
      backend_(config_.backend.name == "cpu" ? cpuBackend() : gpu_.backend()),
      queries_(CloudRows(), threads_) {
  backend_->check(config_);
  ModelLoading loading{.log = messages_.sink(), .threads = threads_, .estimate = backend_->normalEstimator()};
  if (subject.join) loading.join = joined_.emplace(*subject.join).joiner();
  model_ = std::make_shared<const Model>(modelFrom(subject, config_, loading));
  queries_ = {subject.clouds.empty() ? CloudRows(model_->cloud.size()) : CloudRows(subject.clouds), threads_};
  if (isOpen(options) && budget_us_ > 0 && !subject.frames) takeSooner();
  if (hasArrays(subject) && !knownScaleOf(model_->cloud, config_.model.mm_per_unit))
    messages_.sink().say(
        "the longest side, {:.6g} model units, is felt as {:.6g} mm: 1 unit is {:.6g} mm in the hand, where all "
        "lengths "
        "in mm are measured, as a brush's radius_mm is; mm_per_unit sets the true scale",
        boundsOf(model_->cloud).longestSide(), kDefaultLongestSide_mm, model_->scale.mm_per_unit);
  if (joined_ && model_->cloud.empty()) throw Error("'{}' contains no points", subject.model.file);
  if (subject.frames) {
    const std::size_t most = subject.frames->max_points ? subject.frames->max_points : model_->cloud.size();
    frames_ = std::make_unique<PushedFrames>(model_->cloud, most, subject.frames->stable_rows != 0);
  }
  law_ = ForceFunction(options.law, options.law_user, textOf(options.law_library), model_->scale.mm_per_unit);
  hasLaw_ = static_cast<bool>(law_.custom());
  build(false, false);
}

OpenSession::~OpenSession() { end(); }

void OpenSession::takeSooner() {
  if (config_.backend.name == "cpu") return;
  std::unique_ptr<BackendKind> cpu = cpuBackend();
  const BackendKind& sooner = soonerBackend(
      config_, *model_,
      {.gpu = *backend_, .cpu = *cpu, .threads = threads_, .log = messages_.sink(), .laterBrush = BrushConfig{}});
  if (&sooner != cpu.get()) return;
  config_.backend.name = cpu->name();
  backend_ = std::move(cpu);
}

void OpenSession::end() noexcept {
  try {
    if (live_) live_->stop();
    leave();
    endRecording();
  } catch (const std::exception& error) {  // the log has all that could be written
    messages_.sink().warn("{}", error.what());
  }
  messages_.end();
}

// Delivers this hand's last edits, which may still be in flight.
void OpenSession::leave() {
  if (joined_ && session_) session_->deliver(joined_->timeout_s());
}

const JoinedPart& OpenSession::joined() const {
  if (!joined_) throw StateError("this session was not joined; it belongs to this program only");
  return *joined_;
}

void OpenSession::checkShared() const {
  if (joined_) joined_->check(*session_);
}

bool OpenSession::settleShared(double seconds) {
  joined();
  endAsking();
  session_->backend().finish();
  session_->catchUp();
  checkShared();
  const bool isSame = session_->settleShared(seconds, Session::Settling::all);
  checkShared();
  return isSame;
}

// Restores the previous session if the new one cannot be built.
void OpenSession::build(bool journal, bool editable) {
  if (!session_) return make(config_, journal, editable);
  const SessionConfig before = session_->config();
  const bool hadJournal = session_->journal() != nullptr, wasEditable = editable_;
  try {
    make(before, journal, editable);
  } catch (const Stopped&) {
    unbuilt_ = Built{before, hadJournal, wasEditable};  // rebuilding it now would take as long again
    throw;
  } catch (...) {
    unbuilt_ = Built{before, hadJournal, wasEditable};
    ensureBuilt();
    throw;
  }
}

void OpenSession::ensureBuilt() {
  if (!unbuilt_) return;
  make(unbuilt_->config, unbuilt_->journal, unbuilt_->editable);
  if (unbuilt_->config.brush) session_->setBrush(unbuilt_->config.brush);
  unbuilt_.reset();
}

void OpenSession::make(SessionConfig config, bool journal, bool editable) {
  if (editable && !config.brush) config.brush = BrushConfig{};
  UndoConfig undo = config.undo;
  undo.undo = 1;  // any number above 0, so that memory for undo is allocated
  session_.reset();
  gpu_.forgetPicture();
  queries_.forget();
  const JobStopScope cuts(JobStopScope::cutting());
  session_ = std::make_unique<Session>(
      config, model_,
      SessionParts{.backend = *backend_,
                   .threads = threads_,
                   .journal = journal,
                   .undo_bytes = undoBytes(undo),
                   .paintable = editable,
                   .sharedPatience_s = joined_ ? joined_->timeout_s() : kSharedPatience_s,
                   .log = &messages_.sink(),
                   .source = frames_.get(),
                   .followers = {[this](const Model&, TouchBackend&) { return std::make_unique<Followers>(*this); }}});
  if (editable) session_->setBrush(std::nullopt);
  editable_ = editable || session_->shared() || session_->far();  // else a brush is refused with a reason
}

void OpenSession::endAsking() {
  if (isLive()) throw StateError("the session is live; stop it first");
  session_->endPulling();
  events_.endAll();
}

void OpenSession::settle() {
  endAsking();
  if (hasFailed()) {
    if (session_->recording()) session_->abandonRecording();  // its end is unknown
    return session_->catchUp();                               // only a reset is possible
  }
  session_->finish();
  endRecording();
}

void OpenSession::record(const std::string& file) {
  settle();
  if (hands() > 1) throw StateError("a session log holds one hand, and this session has {}", hands());
  if (hasLaw_) throw StateError("a session with its own force law cannot be replayed, and so cannot be recorded");
  const ShapeStrokes* const shape = session_->backend().shapeStrokes();
  if (const Abilities can = session_->abilities(); !can.allow(Action::record))
    throw StateError("{}", can.refusal(Action::record));
  if (edits_ > 0 || (shape && shape->counts().version > 0))
    throw StateError(
        "a log begins with the points as they were opened, but these have been edited; save them, and open the "
        "saved file");
  if (!session_->journal()) build(true, false);
  recordTo_ = file;
}

void OpenSession::beginRecording(const OpenHand& hand, const RunOptions& run) {
  if (!recordTo_) return;
  const std::string file = *std::exchange(recordTo_, std::nullopt);
  session_->record(
      file, hand, [this](const std::string& what) { messages_.sink().warn("{}", what); }, run);
}

void OpenSession::endRecording() {
  if (session_) session_->endRecording();
}

void OpenSession::requireRunning() const {
  if (hasFailed())
    throw SimulationError("the simulation {}; restart it with more substeps or a slower hand",
                          session_->simulation()->failure());
}

// Where points move and time continues, a hand that begins where it ended keeps its contact.
bool OpenSession::goesOn(std::size_t hand, const Path& path) const {
  constexpr double kSamePlace_mm = 1;
  return next_s_ > 0 && hand < hips_.size() &&
         model_->scale.toMm(glm::distance(path.at(0), hips_[hand])) <= kSamePlace_mm;
}

ServoResult OpenSession::run(const std::vector<Path>& paths, const std::optional<BrushConfig>& brush) {
  settle();
  checkShared();
  struct BrushBefore {
    ~BrushBefore() {
      try {
        of.setBrushBetween(brush);
      } catch (const std::exception& error) {
        of.messages_.sink().warn("{}", error.what());
      }
    }
    OpenSession& of;
    std::optional<BrushConfig> brush;
  } before{*this, brush_};  // restored even if the path fails
  setBrushBetween(brush);
  if (recordTo_ || reset_.exchange(false)) next_s_ = 0;  // a log begins at 0
  std::vector<PathDevice> devices;
  devices.reserve(paths.size());
  std::vector<OpenHand> hands;
  for (const Path& path : paths) {
    devices.emplace_back(later(path, next_s_));
    hands.push_back({.device = &devices.back(), .duration_s = path.duration_s()});
    if (!goesOn(hands.size() - 1, path)) session_->backend().resetHand(hands.size() - 1);
  }
  beginRecording(hands.front(), {});
  double duration_s = 0;
  for (const OpenHand& hand : hands) duration_s = std::max(duration_s, hand.duration_s);
  const TickObserver tells = [&](const TraceRow& row) {
    watch_->progressed("touching", duration_s > 0 ? std::min(1.0, (row.time_s - next_s_) / duration_s) : 1.0);
  };
  ServoResult result = session_->run(
      hands, {.begin_s = next_s_, .observer = watch_->isTold() ? tells : TickObserver(), .law = law_.custom()});
  if (moves() && !result.trace().rows.empty()) next_s_ = result.trace().rows.back().time_s + 1 / config_.rate_Hz;
  if (hasFailed()) session_->abandonRecording();  // its end is unknown
  hips_.clear();
  for (const HandResult& hand : result.hands)
    if (moves() && !hand.trace.rows.empty()) hips_.push_back(hand.trace.rows.back().hip);
  requireRunning();
  session_->finish();
  endRecording();
  return result;
}

void OpenSession::setBrush(const std::optional<BrushConfig>& brush) {
  settle();
  setBrushBetween(brush);
}

void OpenSession::setBrushBetween(const std::optional<BrushConfig>& asked) {
  const auto brush = asked && joined_ ? joined_->allowed(*asked, *session_) : asked;
  if (brush == brush_) return;
  if (frames_) session_->abilities().require(Action::sculpt, "brush");
  SessionConfig wanted = session_->config();
  wanted.brush = brush;
  validate(wanted);
  backend_->check(wanted);
  if (brush && !editable_ && !moves()) build(true, true);  // a soft body takes a brush without a rebuild
  session_->setBrush(brush);
  brush_ = brush;
  session_->finish();
}

void OpenSession::setContact(const SurfaceConfig& surface, const ForceOptions& force) {
  settle();
  SurfaceConfig there = surface;
  there.radius_mm = session_->config().surface.radius_mm;
  if (surface.radius_mm && surface.radius_mm != there.radius_mm)
    throw UsageError("contact.radius_mm: a session keeps the support radius that it was opened with");
  session_->setContact(there, force, session_->config().backend.method);
}

std::size_t OpenSession::goBack(std::size_t undo, std::size_t redo) {
  settle();
  session_->require(Action::undo, "undo");
  if (!session_->journal() && !session_->backend().shapeStrokes()) return 0;
  const UndoneStrokes strokes = session_->undo(undo, redo);
  if (joined_) {
    session_->settleShared(joined_->timeout_s());
    if (session_->shared() && !session_->shared()->counts().delivered)
      messages_.sink().warn(
          "'{}': the server has not confirmed yet what was undone or redone here; settling waits for it",
          config_.model.file);
  }
  return strokes.undone + strokes.redone;
}

PointCloud OpenSession::points() {
  settle();
  return present();
}

void OpenSession::startLive(const pp_live_options& options) {
  settle();
  checkShared();
  live_.reset();
  next_s_ = 0;
  hips_.clear();
  if (frames_) frames_->restart();
  for (std::size_t i = 0; i < hands(); ++i) session_->backend().resetHand(i);
  live_.emplace(options,
                LiveHands::Surroundings{
                    .session = *session_, .log = messages_.sink(), .forcesOn = forcesOn_, .law = law_.custom()});
  try {
    if (recordTo_ && live_->hasLaw())
      throw StateError("a session with its own force law cannot be replayed, and so cannot be recorded");
    beginRecording(live_->first(), {.rate_Hz = live_->rate_Hz(), .realtime = true});
    live_->start();
  } catch (...) {
    live_.reset();  // closes its devices
    throw;
  }
  framesGoOn_ = true;
}

void OpenSession::stopLive() {
  if (live_) live_->stop();
  if (frames_ && std::exchange(framesGoOn_, false)) {
    session_->backend().finish();  // frames in progress are for the old time and would include new frames
    frames_->restart();            // the next path begins at 0
  }
  if (!session_->recording()) return takeIn();
  if (hasFailed()) session_->abandonRecording();
  session_->finish();
  endRecording();
}

void OpenSession::touch(std::span<const Pose> poses, std::span<pp_contact> contacts, double* torques_mNm) {
  if (poses.size() != hands())
    throw UsageError("hands: {} poses were given to a session of {} hands", poses.size(), hands());
  if (!session_->isPulled()) {
    if (isLive()) throw StateError("the session is live; stop it first");
    checkShared();
    session_->pull({.budget_us = budget_us_, .law = law_.custom()});
  }
  reset_.store(false, std::memory_order_relaxed);
  hips_.clear();
  next_s_ = moves() ? poses.front().time_s + 1 / config_.rate_Hz : 0;
  const std::span<const PulledTick> ticks = session_->tick(poses);
  std::array<pp_contact, PP_MAX_HANDS> felt;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    felt[i] = contactOf(ticks[i].contact, poses[i], ticks[i].force_N, model_->scale.mm_per_unit);
    events_.felt(i, poses[i].time_s, felt[i]);
  }
  std::copy_n(felt.begin(), ticks.size(), contacts.begin());  // after the function of the program, which may throw
  for (std::size_t i = 0; torques_mNm && i < ticks.size(); ++i)
    for (int k = 0; k < 3; ++k) torques_mNm[3 * i + static_cast<std::size_t>(k)] = ticks[i].torque_mNm[k];
}

void OpenSession::lift() {
  session_->lift();
  events_.endAll();
}

void OpenSession::takeIn() { session_->catchUp(); }

pp_session_info OpenSession::info() const {
  pp_session_info info = usual<pp_session_info>();
  const ModelScale& scale = model_->scale;
  info.live = isLive();
  info.points = model_->cloud.size();
  info.mm_per_unit = scale.mm_per_unit;
  info.spacing_mm = scale.toMm(model_->spacing);
  info.radius_mm = scale.toMm(session_->surface().radius);
  info.rate_Hz = session_->config().rate_Hz;
  const StrokeCounts strokes = session_->strokes();
  info.undo_count = strokes.undoCount;
  info.redo_count = strokes.redoCount;
  info.edits = edits_;
  putText(config_.backend.name, info.backend);
  putText(session_->machine(), info.machine);
  return info;
}

PointCloud OpenSession::present() {
  const JobStopScope cuts(JobStopScope::cutting());
  if (!moves()) return session_->journal() ? session_->sculpted().cloud : model_->cloud;
  const auto now = frame();
  PointCloud cloud = now->cloud;
  if (cloud.size() == model_->cloud.size()) cloud.colors = model_->cloud.colors;
  cloud.storedAs.comments = model_->cloud.storedAs.comments;
  return cloud;
}

Image OpenSession::draw(const PictureRequest& request) {
  takeIn();
  const JobStopScope cuts(JobStopScope::cutting());
  try {
    if (!moves()) return gpu_.draw(*model_, session_->journal(), request);
    gpu_.forgetPicture();
    Model now = *model_;
    now.cloud = present();
    return gpu_.draw(now, nullptr, request);
  } catch (const Stopped&) {
    gpu_.forgetPicture();  // it may be incomplete
    throw;
  }
}

const SurfaceIndex& OpenSession::surfaceIndex() {
  takeIn();
  return queries_.surfaceOf(*session_, moves() ? frame() : nullptr);
}

std::vector<pp_row> OpenSession::rows() {
  if (moves()) throw StateError("the points of this session move, and have no rows of a cloud; read them as a frame");
  takeIn();
  return queries_.rowsOf(*session_);
}

Mesh OpenSession::mesh(const pp_mesh_options& options) {
  takeIn();
  const PointCloud cloud = present();
  const JobStopScope cuts(JobStopScope::cutting());
  return gpu_.mesh(cloud, planMesh(boundsOf(cloud), model_->spacing, meshFrom(options, model_->scale)));
}

}  // namespace palpate::library
