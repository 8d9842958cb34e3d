#include "haptics/library/open_session.hpp"

#include <algorithm>
#include <cstring>

#include "engine/edit/journal.hpp"
#include "haptics/devices/path_device.hpp"
#include "haptics/library/options.hpp"

namespace palpate::library {

namespace {

SessionConfig configFrom(const pp_session_options& options) {
  const pp_feel feel = optionsFrom(options.feel, pp_default_feel(), "feel");
  SessionConfig config{.model = {.file = "the cloud",
                                 .mm_per_unit = options.mm_per_unit,
                                 .normals = options.estimate_normals ? NormalSource::estimate : NormalSource::keep},
                       .surface = surfaceFrom(feel),
                       .force = forceFrom(feel)};
  config.rate_Hz = options.rate_Hz;
  config.undo.memory_MiB = options.undo_memory_MiB;
  const std::string gpu = textOf(options.gpu);
  config.backend.name = gpu == "cpu" || (gpu.empty() && !hasRealGpu()) ? "cpu" : "vulkan";
  validate(config);
  return config;
}

double budgetFrom(const pp_session_options& options) {
  constexpr double kLongest_us = 1e9;
  if (!(options.budget_us >= 0 && options.budget_us <= kLongest_us))
    throw UsageError("budget_us: {} is not between 0 and {}", options.budget_us, kLongest_us);
  return options.budget_us;
}

std::string gpuFrom(const pp_session_options& options) {
  const std::string gpu = textOf(options.gpu);
  return gpu == "cpu" ? std::string() : gpu;
}

template <std::size_t kSize>
void putText(std::string_view text, char (&to)[kSize]) {
  const std::size_t length = std::min(text.size(), kSize - 1);
  std::memcpy(to, text.data(), length);
  to[length] = '\0';
}

}  // namespace

/// What hears of every edit.
class OpenSession::Followers final : public EditFollower {
 public:
  explicit Followers(OpenSession& session) : session_(session) {}
  void catchUp(const EditBatch& batch) override {
    session_.edits_ += batch.points.size();
    session_.gpu_.follow(batch);
  }

 private:
  OpenSession& session_;
};

OpenSession::OpenSession(const PointCloud& cloud, const pp_session_options& options)
    : remarks_(options.log, options.log_user),
      config_(configFrom(options)),
      threads_(options.threads),
      budget_us_(budgetFrom(options)),
      gpu_(gpuFrom(options)),
      backend_(config_.backend.name == "cpu" ? cpuBackend() : gpu_.backend()) {
  if (cloud.empty()) throw UsageError("the cloud has no points; there is nothing to touch");
  model_ = std::make_shared<const Model>(modelOf(
      cloud, config_.model,
      {.log = remarks_.sink(), .threads = threads_, .estimate = backend_->normalEstimator()}));
  law_ = ForceFunction(options.law, options.law_user, textOf(options.law_library), model_->scale.mm_per_unit);
  build(false);
}

OpenSession::~OpenSession() = default;

void OpenSession::build(bool editable) {
  SessionConfig config = session_ ? session_->config() : config_;
  if (editable) config.brush = BrushConfig{};
  UndoConfig undo = config.undo;
  undo.undo = 1;  // any number, so that there is room for some
  session_.reset();
  gpu_.forgetPicture();
  session_ = std::make_unique<Session>(
      config, model_,
      SessionParts{.backend = *backend_,
                   .threads = threads_,
                   .journal = editable,
                   .undo_bytes = undoBytes(undo),
                   .paintable = editable,
                   .log = &remarks_.sink(),
                   .follower = [this](const Model&, TouchBackend&) { return std::make_unique<Followers>(*this); }});
  if (editable) session_->setBrush(std::nullopt);
}

void OpenSession::settle() {
  if (isLive()) throw StateError("the session is live; pp_live_stop() comes first");
  if (asked_) {
    asked_->check();
    asked_.reset();
  }
  session_->finish();
}

ServoResult OpenSession::run(Path path, const std::optional<BrushConfig>& brush) {
  const std::optional<BrushConfig> before = brush_;
  setBrush(brush);
  const double duration_s = path.duration_s();
  PathDevice device(std::move(path));
  const OpenHand hand{.device = &device, .duration_s = duration_s};
  session_->backend().resetHand(0);
  ServoResult result = session_->run({&hand, 1}, {.law = law_.custom()});
  session_->finish();
  setBrush(before);
  return result;
}

void OpenSession::setBrush(const std::optional<BrushConfig>& brush) {
  settle();
  if (brush == brush_) return;
  SessionConfig wanted = session_->config();
  wanted.brush = brush;
  validate(wanted);
  backend_->check(wanted);
  if (!session_->journal()) build(true);
  session_->setBrush(brush);
  session_->finish();
  brush_ = brush;
}

void OpenSession::setFeel(const SurfaceConfig& surface, const ForceOptions& force) {
  settle();
  SurfaceConfig there = surface;
  there.radius_mm = session_->config().surface.radius_mm;
  if (surface.radius_mm && surface.radius_mm != there.radius_mm)
    throw UsageError("feel.radius_mm: a session keeps the support radius that it was opened with");
  session_->setFeel(there, force, session_->config().backend.method);
}

std::size_t OpenSession::goBack(std::size_t undo, std::size_t redo) {
  settle();
  if (!session_->journal()) return 0;
  const UndoneStrokes strokes = session_->undo(undo, redo);
  return strokes.undone + strokes.redone;
}

PointCloud OpenSession::points() {
  settle();
  return session_->journal() ? session_->sculpted().cloud : model_->cloud;
}

void OpenSession::startLive(const pp_live_options& options) {
  settle();
  live_.reset();
  session_->backend().resetHand(0);
  live_.emplace(options, LiveHand::Surroundings{.session = *session_,
                                                .log = remarks_.sink(),
                                                .forcesOn = forcesOn_,
                                                .law = law_.custom()});
}

AskedTick OpenSession::touch(const Pose& pose) {
  if (!asked_) {
    if (isLive()) throw StateError("the session is live; pp_live_stop() comes first");
    asked_.emplace(*session_, AskedHandOptions{.budget_us = budget_us_, .law = law_.custom()});
  }
  return asked_->tick(pose);
}

void OpenSession::lift() {
  if (asked_) asked_->lift();
}

void OpenSession::takeIn() { session_->relay().catchUp(); }

pp_session_info OpenSession::info() const {
  pp_session_info info = pp_default_session_info();
  const ModelScale& scale = model_->scale;
  info.live = isLive();
  info.points = model_->cloud.size();
  info.mm_per_unit = scale.mm_per_unit;
  info.spacing_mm = scale.toMm(model_->spacing);
  info.radius_mm = scale.toMm(session_->surface().radius);
  info.rate_Hz = session_->config().rate_Hz;
  if (const Journal* journal = session_->journal()) {
    info.undoable = journal->undoable();
    info.redoable = journal->redoable();
  }
  info.edits = edits_;
  putText(config_.backend.name, info.backend);
  putText(session_->backend().machine(), info.machine);
  return info;
}

Image OpenSession::draw(const PictureRequest& request) {
  takeIn();
  return gpu_.draw(*model_, session_->journal(), request);
}

Mesh OpenSession::mesh(const pp_mesh_options& options) {
  takeIn();
  const PointCloud cloud = session_->journal() ? session_->sculpted().cloud : model_->cloud;
  return gpu_.mesh(cloud, planMesh(boundsOf(cloud), model_->spacing, meshFrom(options, model_->scale)));
}

}  // namespace palpate::library
