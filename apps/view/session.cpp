#include "apps/view/session.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <utility>

#include "apps/devices.hpp"
#include "apps/touch.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/saving.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "haptics/devices/replay_device.hpp"

namespace palpate {

namespace {

constexpr double kParked = 3;  // longest sides from the middle of the model: where a lifted stylus waits

std::string_view nameOf(const auto& names, auto value) {
  for (const auto& [name, each] : names)
    if (each == value) return name;
  return {};
}

WorkspaceMap mapFor(const Model& model, const Bounds& bounds) {
  return {.scale = model.scale.toUnits(1), .offset = model.cloud.origin + bounds.center()};
}

DVec3 parkingPlace(const Model& model, const Bounds& bounds) {
  return model.cloud.origin + bounds.center() + DVec3(0, kParked * std::max(bounds.longestSide(), 1e-3), 0);
}

std::optional<BrushOptions> brushOf(const ToolSettings& tool, const ModelScale& scale) {
  if (!tool.brush) return std::nullopt;
  return BrushOptions{.kind = *tool.brush,
                      .tau = scale.toUnits(tool.tau_mm),
                      .beta = tool.beta,
                      .toolRadius = scale.toUnits(tool.radius_mm),
                      .strength = tool.strength,
                      .falloff = tool.falloff,
                      .color = {tool.color[0], tool.color[1], tool.color[2], 255}};
}

// What a session is built with: whichever brush comes first, others may follow.
BrushOptions firstBrush(const ToolSettings& tool, const ModelScale& scale) {
  ToolSettings any = tool;
  any.brush = BrushKind::push;
  return *brushOf(any, scale);
}

BackendOptions backendOptions(const SessionOptions& options, const FeelSettings& feel) {
  BackendOptions backend = options.backend;
  backend.realtime = true;
  backend.paintable = true;
  backend.surface = nameOf(kSurfaceKinds, feel.surface);
  backend.friction = feel.friction;
  if (backend.backend == "vulkan") backend.method = nameOf(kQueryMethods, feel.method);
  return backend;
}

ForceOptions forceOptions(const FeelSettings& feel) {
  return {.stiffness_N_per_mm = feel.stiffness_N_per_mm,
          .damping_N_s_per_mm = feel.damping_N_s_per_mm,
          .maxForce_N = feel.maxForce_N};
}

}  // namespace

/// A log under way.
struct Session::Recording {
  Recording(const std::string& file, std::string text, const TouchBackend& backend, double rate_Hz)
      : writer(file, std::move(text),
               [this](const std::string& what) {
                 const std::scoped_lock hold(lock);
                 fault = what;
               }),
        tap(backend, [this, rate_Hz](const LoggedTick& tick) {
          LoggedTick moved = tick;
          moved.time_s = std::round((tick.time_s - begin_s) * rate_Hz) / rate_Hz;  // as a replay counts them
          writer.add(moved);
        }) {}
  std::mutex lock;    // of
  std::string fault;  // that nobody was told yet
  SessionWriter writer;
  double begin_s = 0;  // of the first tick, whose time in the log is 0
  TickTap tap;
};

Session::Session(Context& context, Device& sight, Model model, const SessionOptions& options, const ToolSettings& tool,
                 const FeelSettings& feel)
    : context_(context),
      options_(options),
      model_(std::move(model)),
      bounds_(boundsOf(model_.cloud)),
      tool_(tool),
      feel_(feel),
      stylus_(mapFor(model_, bounds_), parkingPlace(model_, bounds_)),
      map_(options.device ? mapInto(options.deviceFacts, model_) : mapFor(model_, bounds_)),
      history_(1 / options.rate_Hz) {
  if (model_.cloud.empty()) throw FileError(options.model.file, "has no points; there is nothing to touch");
  backend_ = makeBackend(context, model_, backendOptions(options, feel), firstBrush(tool, model_.scale));
  followers_.emplace(
      context, model_, *backend_,
      FollowersWanted{.picture = true, .journal = true, .undo_bytes = options.undo_bytes, .sight = &sight});
  journal_ = followers_->journal();
  if (tool.brush != BrushKind::push) backend_->setBrush(brush());
  start();
}

Session::~Session() {
  stop();
  if (saving_.valid()) saving_.wait();
}

HapticDevice& Session::stylus() {
  if (options_.device) return *options_.device;
  return stylus_;
}

void Session::start() {
  stop_ = false;
  ended_ = false;
  thread_ = std::jthread([this] {
    try {
      ServoLoop loop(playing_ ? *playing_->device : stylus(), *backend_, ForceLaw(forceOptions(feel_), model_.scale),
                     {.rate_Hz = options_.rate_Hz,
                      .begin_s = next_s_,
                      .endless = true,
                      .realtime = true,
                      .map = playing_ ? playing_->map : map_,
                      .stop = &stop_,
                      .forcesOn = &forcesOn_,
                      .recorder = &feed_});
      const ServoResult result = loop.run();
      if (result.deviceFailed) fault_ = result.fault;
      if (result.queryLost) fault_ = backend_->machine() + " was lost: what it gave before is kept";
    } catch (const std::exception& error) {
      fault_ = error.what();
    }
    ended_ = true;
  });
}

void Session::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void Session::finishTicks() {
  takeIn();
  history_.interrupt();
  if (!history_.rows().empty()) next_s_ = history_.rows().back().time_s + 1 / options_.rate_Hz;
  if (lost_) return;
  backend_->finish();
  takeIn();
}

void Session::takeIn() {
  rows_.clear();
  feed_.take(rows_);
  history_.add(rows_);
  followers_->catchUp();
  const EditBatch& fresh = followers_->batch();
  batch_.points.insert(batch_.points.end(), fresh.points.begin(), fresh.points.end());
  edits_ += fresh.points.size();
}

std::optional<std::string> Session::follow() {
  if (lost_) return std::nullopt;
  std::string failure;
  try {
    takeIn();
    if (playing_ && !history_.rows().empty() && history_.rows().back().time_s > playing_->end_s) endPlaying();
    if (ended_ && !stop_) failure = fault_.empty() ? "the servo thread has ended" : fault_;
  } catch (const std::exception& error) {
    failure = error.what();
  }
  if (failure.empty()) return std::nullopt;
  lost_ = true;
  stop();
  return failure;
}

std::optional<BrushOptions> Session::brush() const { return brushOf(tool_, model_.scale); }

void Session::setTool(const ToolSettings& tool) {
  if (tool == tool_ || lost_) return;
  endRecording();
  tool_ = tool;
  between([&] { backend_->setBrush(brush()); });
}

void Session::setFeel(const FeelSettings& feel) {
  if (feel == feel_ || lost_) return;
  endRecording();
  const bool contact = feel.surface != feel_.surface || feel.method != feel_.method || feel.friction != feel_.friction;
  feel_ = feel;
  between([&] {
    if (!contact) return;  // the servo loop begins with the new force law
    if (auto* gpu = dynamic_cast<TouchSide*>(backend_.get())) gpu->setContact(feel.surface, feel.friction, feel.method);
    if (auto* cpu = dynamic_cast<CpuTouch*>(backend_.get())) cpu->setContact(feel.surface, feel.friction);
  });
}

bool Session::takeBack(std::size_t undo, std::size_t redo) {
  if (lost_) return false;
  endRecording();
  return between([&] {
    const StrokesTakenBack back = palpate::takeBack(
        *backend_, *journal_, [&] { takeIn(); }, undo, redo);
    return back.undone + back.redone > 0;
  });
}

bool Session::redo() { return journal_->redoable() > 0 && takeBack(0, 1); }

void Session::save(const std::string& file) {
  if (saving_.valid()) throw Error("{}: the last save is still being written", file);
  if (!lost_) between([] {});
  savingVersion_ = journal_->version();
  std::vector<PointState> points(journal_->points().begin(), journal_->points().end());
  saving_ = std::async(std::launch::async, [this, file, points = std::move(points)] {
    try {
      const std::filesystem::path kept = saveKeeping(file, editedCloud(model_.cloud, points));
      return Saved{file, kept.string(), {}};
    } catch (const std::exception& error) {
      return Saved{file, {}, error.what()};
    }
  });
}

std::optional<Session::Saved> Session::takeSaved() {
  if (!saving_.valid() || saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  const Saved saved = saving_.get();
  if (saved.failure.empty()) savedVersion_ = savingVersion_;
  return saved;
}

void Session::record(const std::string& log) {
  if (edits_ > 0)
    throw Error("{}: a recording begins with the model as its file has it; save it and open the saved file first", log);
  endRecording();
  CLI::App command;
  TouchCommandOptions touch;
  addTouchOptions(command, touch);
  const BackendOptions backend = backendOptions(options_, feel_);
  std::vector<std::string> arguments{fmt::format("--rate={}", options_.rate_Hz),
                                     "--realtime",
                                     "--backend=" + backend.backend,
                                     "--surface=" + backend.surface,
                                     "--radius=" + backend.radius,
                                     fmt::format("--friction={}", feel_.friction),
                                     fmt::format("--stiffness={}", feel_.stiffness_N_per_mm),
                                     fmt::format("--damping={}", feel_.damping_N_s_per_mm),
                                     fmt::format("--max-force={}", feel_.maxForce_N),
                                     fmt::format("--mm-per-unit={}", model_.scale.mm_per_unit),
                                     "--normals=" + options_.model.normals};
  if (!backend.method.empty()) arguments.push_back("--method=" + backend.method);
  if (tool_.brush) {
    const auto& [r, g, b] = tool_.color;
    for (std::string& each : std::vector<std::string>{
             fmt::format("--edit={}", nameOf(kBrushKinds, *tool_.brush)), fmt::format("--tau={}", tool_.tau_mm),
             fmt::format("--beta={}", tool_.beta), fmt::format("--tool-radius={}", tool_.radius_mm),
             fmt::format("--strength={}", tool_.strength), fmt::format("--falloff={}", tool_.falloff),
             fmt::format("--paint-color={},{},{}", r, g, b)})
      arguments.push_back(std::move(each));
  }
  arguments.push_back(file());
  std::ranges::reverse(arguments);  // as CLI11 wants them
  command.parse(std::move(arguments));
  recording_ = std::make_unique<Recording>(log,
                                           sessionText(command, {.modelFile = file(),
                                                                 .points = model_.cloud.size(),
                                                                 .checksum = checksumOf(model_),
                                                                 .machine = machine(),
                                                                 .palpate = PALPATE_VERSION,
                                                                 .limits = stylus().limits(),
                                                                 .map = map_}),
                                           *backend_, options_.rate_Hz);
  between([&] {
    // As a replay begins: with a stylus that was put down nowhere yet.
    backend_->beginAnew();
    recording_->begin_s = next_s_;
    feed_.setListener(&recording_->tap);
    followers_->setLog(&recording_->writer);
  });
}

void Session::endRecording() {
  if (!recording_) return;
  const std::unique_ptr<Recording> recording = std::exchange(recording_, nullptr);
  between([&] {
    feed_.setListener(nullptr);
    followers_->setLog(nullptr);
  });
  try {
    recording->writer.finish(checksumOf(model_.cloud.origin, journal_->points()));
  } catch (const FileError&) {
    if (!recording->fault.empty()) throw;
  }
}

std::optional<std::string> Session::takeRecordingFault() {
  if (!recording_) return std::nullopt;
  const std::scoped_lock hold(recording_->lock);
  if (recording_->fault.empty()) return std::nullopt;
  return std::exchange(recording_->fault, {});
}

std::vector<std::string> Session::play(const std::string& log) {
  SessionRecord record = readSessionLog(log);
  const RecordedSession session = parseSessionText(log, record.text);
  if (record.ticks.empty()) throw FileError(log, "has no whole tick; there is nothing to play");
  std::vector<std::string> lacks = whatIsMissing(record);
  endRecording();
  between([&] {
    backend_->beginAnew();
    for (LoggedTick& tick : record.ticks) tick.time_s += next_s_;
    const double end_s = record.ticks.back().time_s;
    DeviceLimits limits = session.limits;
    playing_ = std::make_unique<Playing>(
        Playing{std::make_unique<ReplayDevice>(std::move(record.ticks), limits), session.map, end_s});
  });
  return lacks;
}

void Session::endPlaying() {
  if (!playing_) return;
  between([&] {
    backend_->beginAnew();
    playing_.reset();
  });
}

}  // namespace palpate
