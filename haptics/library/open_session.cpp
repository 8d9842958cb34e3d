#include "haptics/library/open_session.hpp"

#include <algorithm>
#include <array>

#include "engine/edit/history.hpp"
#include "haptics/crash_stop.hpp"
#include "haptics/devices/path_device.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/backend_choice.hpp"

namespace palpate::library {

// While it lives, all waits for other programs share the timeout of one call.
class OpenSession::OneCall {
 public:
  explicit OneCall(std::optional<Stopwatch>& since) : since_(since) { since.emplace(); }
  ~OneCall() { since_.reset(); }
  OneCall(const OneCall&) = delete;
  OneCall& operator=(const OneCall&) = delete;

 private:
  std::optional<Stopwatch>& since_;
};

namespace {

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

std::unique_ptr<BackendKind> checkedBackend(const SessionConfig& config, SessionViews& views) {
  auto backend = config.backend.name == "cpu" ? cpuBackend() : views.gpuBackend();
  backend->check(config);
  return backend;
}

}  // namespace

OpenSession::OpenSession(const Subject& subject, const pp_session_options& options, std::shared_ptr<Watch> watch)
    : OpenSession(subject, options, std::move(watch), configFrom(subject, options)) {}

OpenSession::OpenSession(const Subject& subject, const pp_session_options& options, std::shared_ptr<Watch> watch,
                         const SessionConfig& config)
    : watch_(std::move(watch)),
      messages_(options.log, options.log_user, *watch_),
      budget_us_(budgetFrom(options)),
      views_({options.gpu, options.vulkan}, options.threads),
      backend_(checkedBackend(config, views_)),
      joined_(subject.join ? std::optional<JoinedPart>(*subject.join) : std::nullopt),
      model_(std::make_shared<const Model>(modelFrom(subject, config,
                                                     {.log = messages_.sink(),
                                                      .threads = options.threads,
                                                      .estimate = backend_->normalEstimator(),
                                                      .join = joined_ ? joined_->joiner() : SessionJoiner()}))),
      law_(options.law, options.law_user, textOf(options.law_library), model_->scale.mm_per_unit),
      frames_(subject.frames, *model_),
      session_({.config = takeSooner(subject, options, config),
                .model = model_,
                .backend = *backend_,
                .threads = options.threads,
                .sharedPatience_s = joined_ ? joined_->timeout_s() : kSharedPatience_s,
                .log = messages_.sink(),
                .source = frames_.pushed(),
                .follower = views_.follower(),
                .forgets = [this] { views_.forget(); }}) {
  views_.setRows(subject.clouds.empty() ? CloudRows(model_->cloud.size()) : CloudRows(subject.clouds));
  if (subject.hasArrays() && !knownScaleOf(model_->cloud, config.model.mm_per_unit))
    messages_.sink().say(
        "the longest side, {:.6g} model units, is felt as {:.6g} mm: 1 unit is {:.6g} mm in the hand, where all "
        "lengths in mm are measured, as a brush's radius_mm is; mm_per_unit sets the true scale",
        model_->shownBounds().longestSide(), kDefaultLongestSide_mm, model_->scale.mm_per_unit);
  if (joined_ && model_->cloud.empty()) throw Error("'{}' contains no points", subject.model.file);
  session_.build(false, false);
}

OpenSession::~OpenSession() { end(); }

SessionConfig OpenSession::takeSooner(const Subject& subject, const pp_session_options& options, SessionConfig config) {
  if (!isOpen(options) || budget_us_ <= 0 || subject.frames || config.backend.name == "cpu") return config;
  std::unique_ptr<BackendKind> cpu = cpuBackend();
  const BackendKind& sooner = soonerBackend(config, *model_,
                                            {.gpu = *backend_,
                                             .cpu = *cpu,
                                             .threads = options.threads,
                                             .log = messages_.sink(),
                                             .laterBrush = BrushConfig{}});
  if (&sooner != cpu.get()) return config;
  config.backend.name = cpu->name();
  backend_ = std::move(cpu);
  return config;
}

bool OpenSession::end() noexcept {
  if (std::exchange(hasEnded_, true)) return true;
  bool isDelivered = true;
  try {
    if (live_) live_->stop();
    isDelivered = leave();
    endRecording();
  } catch (const std::exception& error) {  // the log has all that could be written
    messages_.sink().warn("{}", error.what());
  }
  messages_.end();
  return isDelivered;
}

// Delivers this hand's last edits, which may still be in flight.
bool OpenSession::leave() { return !joined_ || !session_ || session_->deliver(joined_->timeout_s()); }

double OpenSession::timeLeft_s() const {
  return std::max(0.0, joined_->timeout_s() - (since_ ? since_->elapsed_s() : 0));
}

void OpenSession::finish() {
  if (joined_) session_->setSharedPatience(timeLeft_s());
  session_->finish();
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
  requireNotLive();
  session_->checkPulling();
  session_->backend().finish();
  session_->catchUp();
  checkShared();
  const bool isSame = session_->settleShared(seconds, Session::Settling::all);
  checkShared();
  return isSame;
}

ServerSave OpenSession::saveAtServer(double seconds) {
  joined();
  if (isLive())
    session_->between([] {});  // takes the edits
  else
    settle();
  checkShared();
  return session_->saveAtServer(seconds).value_or(ServerSave{.words = "its points cannot be sculpted"});
}

void OpenSession::requireNotLive() const {
  if (isLive()) throw StateError("the session is live; stop it first");
}

void OpenSession::endAsking() {
  session_->endPulling();
  events_.endAll();
}

void OpenSession::settle() {
  requireNotLive();
  session_->checkPulling();
  if (session_.hasFailed()) {
    if (session_->recording()) session_->abandonRecording();  // its end is unknown
    return session_->catchUp();                               // only a reset is possible
  }
  finish();
  endRecording();
}

void OpenSession::settleForCommand() {
  if (!isLive()) settle();
}

void OpenSession::requireRecordable() {
  if (hands() > 1) throw StateError("a session log holds one hand, and this session has {}", hands());
  if (law_.custom()) throw StateError("a session with its own force law cannot be replayed, and so cannot be recorded");
  if (const Abilities can = session_->abilities(); !can.allow(Action::record))
    throw StateError("{}", can.refusal(Action::record));
  if (views_.edits() > 0 || session_->strokes().version > 0)
    throw StateError(
        "a log begins with the points as they were opened, but this session has edited them, even if all is undone; "
        "save the points, and open the saved file");
}

void OpenSession::record(const std::string& file) {
  if (isLive()) {
    if (live_->hasLaw())
      throw StateError("a session with its own force law cannot be replayed, and so cannot be recorded");
    if (!session_->pointHistory())
      throw StateError("this session was built for feeling; set a brush or record before it is live");
    endRecording();
    takeIn();
    requireRecordable();
    nextLog_.set(file);
    return nextLog_.begin(*session_, live_->first(), {.rate_Hz = live_->rate_Hz(), .realtime = true}, messages_.sink());
  }
  settle();
  requireRecordable();
  if (!session_->pointHistory()) session_.build(true, false);
  nextLog_.set(file);
}

void OpenSession::endRecording() {
  if (session_) session_->endRecording();
}

ServoResult OpenSession::run(const std::vector<Path>& paths, const std::optional<BrushConfig>& brush) {
  const OneCall call(since_);
  settle();
  endAsking();
  checkShared();
  struct BrushBefore {
    ~BrushBefore() {
      try {
        try {
          of.setBrushBetween(brush);
        } catch (const std::exception& error) {
          of.messages_.sink().warn("{}", error.what());
        }
      } catch (...) {  // no memory for the warning either
      }
    }
    OpenSession& of;
    std::optional<BrushConfig> brush;
  } before{*this, brush_};  // restored even if the path fails
  setBrushBetween(brush);
  ServoResult result = follow(paths);
  if (session_.hasFailed()) {
    session_->abandonRecording();  // its end is unknown
    throw SimulationError("the simulation {}; restart it with more substeps or a slower hand",
                          session_->simulation()->failure());
  }
  finish();
  endRecording();
  if (brush) requireDelivered("this stroke");
  return result;
}

ServoResult OpenSession::follow(const std::vector<Path>& paths) {
  if (nextLog_ || time_.takeReset()) time_.restart();  // a log begins at 0
  std::vector<PathDevice> devices;
  devices.reserve(paths.size());
  std::vector<OpenHand> hands;
  double duration_s = 0;
  for (const Path& path : paths) {
    devices.emplace_back(time_.later(path));
    if (!time_.goesOn(hands.size(), path, model_->scale)) session_->backend().resetHand(hands.size());
    hands.push_back({.device = &devices.back(), .duration_s = path.duration_s()});
    duration_s = std::max(duration_s, path.duration_s());
  }
  nextLog_.begin(*session_, hands.front(), {}, messages_.sink());
  const double begin_s = time_.begin_s();
  const TickObserver tells = [&](const TraceRow& row) {
    watch_->progressed("touching", duration_s > 0 ? std::min(1.0, (row.time_s - begin_s) / duration_s) : 1.0);
  };
  if (joined_) session_->setSharedPatience(timeLeft_s());
  ServoResult result = session_->run(
      hands, {.begin_s = begin_s, .observer = watch_->isTold() ? tells : TickObserver(), .law = law_.custom()});
  if (moves()) time_.ended(result, 1 / session_.opened().rate_Hz);
  return result;
}

void OpenSession::setBrush(const std::optional<BrushConfig>& brush) {
  settleForCommand();
  setBrushBetween(brush);
}

void OpenSession::setBrushBetween(const std::optional<BrushConfig>& asked) {
  const auto brush = asked && joined_ ? joined_->allowed(*asked, *session_) : asked;
  if (brush == brush_) return;
  if (frames_.pushed()) session_->abilities().require(Action::sculpt, "brush");
  SessionConfig wanted = session_->config();
  wanted.brush = brush;
  validate(wanted);
  backend_->check(wanted);
  const bool isFirst = brush && !session_.isEditable() && !moves();
  if (isFirst && isLive())
    throw StateError("the first brush of a session builds it for sculpting; set one before the session is live");
  if (isFirst) session_.build(true, true);  // a soft body takes a brush without a rebuild
  session_->setBrush(brush);
  brush_ = brush;
  if (!isLive()) finish();
}

void OpenSession::setContact(const SurfaceConfig& surface, const ForceOptions& force) {
  settleForCommand();
  SurfaceConfig there = surface;
  there.radius_mm = session_->config().surface.radius_mm;
  if (surface.radius_mm && surface.radius_mm != there.radius_mm)
    throw UsageError("contact.radius_mm: a session keeps the support radius that it was opened with");
  session_->setContact(there, force, session_->config().backend.method);
}

std::size_t OpenSession::goBack(std::size_t undo, std::size_t redo) {
  const OneCall call(since_);
  settleForCommand();
  session_->require(Action::undo, "undo");
  if (!session_->history()) return 0;
  const UndoneStrokes strokes = session_->undo(undo, redo);
  if (joined_ && !isLive()) session_->settleShared(timeLeft_s());
  return strokes.undone + strokes.redone;
}

// settle() would end the stroke before the session knows that it is in progress.
bool OpenSession::cancelStroke() {
  const OneCall call(since_);
  session_->checkPulling();
  session_->require(Action::undo, "cancel");
  if (session_.hasFailed() || !session_->history()) return false;
  const bool isCancelled = session_->cancelStroke();
  settleForCommand();
  if (joined_ && !isLive()) session_->settleShared(timeLeft_s());
  return isCancelled;
}

PointCloud OpenSession::points() {
  if (isLive()) return session_->between([&] { return views_.points(*session_, frameIfMoving().get()); });
  const auto hasFailed = [&] {
    try {
      session_->backend().finish();
    } catch (...) {
      return true;
    }
    return false;
  };
  try {
    settle();
  } catch (const std::exception& error) {
    if (isLive() || !session_->pointHistory() || !hasFailed()) throw;
    session_->abandonEdits();
    messages_.sink().warn("these are the last known points, without edits that were in progress: {}", error.what());
  }
  return views_.points(*session_, frameIfMoving().get());
}

void OpenSession::setForces(bool on) {
  if (on) CrashStop::resume(&forcesOn_);
  forcesOn_ = on;
}

std::optional<std::string> OpenSession::takeLawFault() {
  if (live_ && live_->hasLaw())
    if (auto fault = live_->takeLawFault()) return fault;
  return law_.takeFault();
}

void OpenSession::startLive(const pp_live_options& options) {
  settle();
  endAsking();
  checkShared();
  live_.reset();
  time_.restart();
  frames_.restart();
  for (std::size_t i = 0; i < hands(); ++i) session_->backend().resetHand(i);
  live_.emplace(options,
                LiveHands::Surroundings{
                    .session = *session_, .log = messages_.sink(), .forcesOn = forcesOn_, .law = law_.custom()});
  try {
    if (nextLog_ && live_->hasLaw())
      throw StateError("a session with its own force law cannot be replayed, and so cannot be recorded");
    nextLog_.begin(*session_, live_->first(), {.rate_Hz = live_->rate_Hz(), .realtime = true}, messages_.sink());
    goesOn_ = true;
    live_->start();
  } catch (...) {
    goesOn_ = false;
    live_.reset();  // closes its devices
    throw;
  }
  frames_.beginLive();
}

void OpenSession::stopLive() {
  goesOn_ = false;
  if (live_) live_->stop();
  frames_.endLive(*session_);
  if (!session_->recording()) return takeIn();
  if (session_.hasFailed()) session_->abandonRecording();
  session_->finish();
  endRecording();
}

void OpenSession::touch(std::span<const Pose> poses, std::span<pp_contact> contacts, double* torques_mNm) {
  if (poses.size() != hands())
    throw UsageError("hands: {} poses were given to a session of {} hands", poses.size(), hands());
  if (time_.takeReset()) session_->lift();  // the scene begins again, and its times with it
  if (!session_->isLater(poses.front().time_s))
    throw UsageError(
        "t_s: {} s is not later than the time of the pose before; times increase by the duration of a "
        "tick, and may begin again after all hands were lifted",
        poses.front().time_s);
  if (!session_->isPulled()) {
    requireNotLive();
    checkShared();
    session_->pull({.budget_us = budget_us_, .law = law_.custom()});
  }
  time_.ticked(moves() ? poses.front().time_s + 1 / session_.opened().rate_Hz : 0);
  const std::span<const PulledTick> ticks = session_->tick(poses);
  std::array<pp_contact, PP_MAX_HANDS> felt;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    felt[i] = contactOf(ticks[i].contact, poses[i], ticks[i].force_N, model_->scale.mm_per_unit);
    felt[i].withheld = ticks[i].withheld;
    events_.felt(i, poses[i].time_s, felt[i]);
  }
  std::copy_n(felt.begin(), ticks.size(), contacts.begin());  // after the function of the program, which may throw
  for (std::size_t i = 0; i < ticks.size(); ++i) putRow(ticks[i].torque_mNm, torques_mNm, i);
}

void OpenSession::lift() {
  session_->lift();
  events_.endAll();
}

}  // namespace palpate::library
