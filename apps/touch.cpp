#include "apps/touch.hpp"

#include <csignal>

#include "apps/followers.hpp"
#include "apps/probe_overlays.hpp"
#include "apps/progress.hpp"
#include "apps/session_text.hpp"
#include "apps/touch_report.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/saving.hpp"
#include "haptics/builtin_path.hpp"
#include "haptics/servo_loop.hpp"

namespace palpate {

namespace {

std::atomic<bool> stopRequested = false;  // what a signal handler may touch

Path pathFor(const std::string& path, const TouchCommandOptions& options, const Model& model) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (path.starts_with(kBuiltin))
    return builtinPath(path.substr(kBuiltin.size()), model.cloud, model.scale, options.penetration_mm);
  return readPathCsv(path);
}

/// The log of a session, where one is asked for, and what writes each tick into it.
class Recording {
 public:
  Recording(Log& log, const std::string& file, const CLI::App& command, const TouchBackend& backend, const Model& model,
            const TouchCommandOptions& options, const Stylus& stylus)
      : writer_(file,
                sessionText(command, {.modelFile = options.model.file,
                                      .points = model.cloud.size(),
                                      .checksum = checksumOf(model),
                                      .machine = backend.machine(),
                                      .palpate = PALPATE_VERSION,
                                      .limits = stylus.device->limits(),
                                      .map = stylus.map,
                                      .passivity = stylus.passivity}),
                [&log](const std::string& what) { log.say("{}", what); }),
        tap_(backend, [this](const LoggedTick& tick) { writer_.add(tick); }) {}

  SessionWriter& writer() { return writer_; }
  TickRecorder& tap() { return tap_; }

 private:
  SessionWriter writer_;
  TickTap tap_;
};

/// What a session leaves, file by file: one that cannot be written is no reason to lose the others.
class Outputs {
 public:
  void write(const std::function<void()>& file) {
    try {
      file();
    } catch (const Error& error) {
      failed(error.what());
    }
  }
  void failed(const std::string& why) { failures_ += (failures_.empty() ? "" : "\npalpate: ") + why; }
  /// Throws Error that names them all.
  void check() const {
    if (!failures_.empty()) throw Error("{}", failures_);
  }

 private:
  std::string failures_;
};

/// The cloud as the session left it, and how many of its points were edited.
struct Sculpted {
  PointCloud cloud;
  std::size_t edited = 0;
};
Sculpted sculpted(const Model& model, const TouchBackend& backend, const Journal* journal) {
  if (journal) return {editedCloud(model.cloud, journal->points()), changedPoints(model.cloud, journal->points())};
  Sculpted sculpted{.cloud = model.cloud};
  sculpted.edited = backend.readBack(sculpted.cloud);
  return sculpted;
}

/// What answers has failed, as `error` says: keeps the points as the journal knows them.
[[noreturn]] void saveAndThrow(const Error& error, const Model& model, const Journal* journal,
                               const std::string& saveFile) {
  if (!journal || saveFile.empty()) throw;
  saveKeeping(saveFile, editedCloud(model.cloud, journal->points()));
  throw Error("{}; {} has the points as they were last told", error.what(), saveFile);
}

/// While it lives, SIGINT and SIGTERM ask for an end.
class StopBySignal {
 public:
  StopBySignal() {
    handle([](int) { stopRequested = true; });
  }
  ~StopBySignal() { handle(SIG_DFL); }
  StopBySignal(const StopBySignal&) = delete;
  StopBySignal& operator=(const StopBySignal&) = delete;

 private:
  static void handle(void (*handler)(int)) {
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, handler);
  }
};

Stylus stylusFor(Context& context, const Model& model, const TouchCommandOptions& options, const StylusOptions& stylus,
                 const std::string& path) {
  const StopBySignal stop;  // a person may be asked to calibrate the device
  return makeStylus(stylus, {.model = model,
                             .path = [&] { return pathFor(path, options, model); },
                             .rate_Hz = options.rate_Hz,
                             .log = context.log(),
                             .stop = &stopRequested});
}

SecondHandReport secondReport(const std::string& device, const SecondResult& result) {
  return {.device = device, .trace = summarize(result.trace), .counts = result.counts};
}

/// Counts the ticks for the bar, and passes them on.
class ShownTicks final : public TickRecorder {
 public:
  /// `next` may be null.
  ShownTicks(Log& log, double duration_s, TickRecorder* next)
      : progress_(log, "touch"), duration_s_(std::max(duration_s, 1e-9)), next_(next) {}
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override {
    if (next_) next_->ticked(row, device);
    progress_.set(row.time_s / duration_s_);
  }

 private:
  Progress progress_;
  double duration_s_;
  TickRecorder* next_;
};

/// Settles what answers, also for the session log, which names it. Whoever names a GPU, or wants its calls watched,
/// means that one, whatever it is.
void chooseBackend(const Context& context, CLI::App& command, BackendOptions& options) {
  const bool means = options.backend == "auto" && options.method != "direct" && context.asksForGpu();
  options.backend = means ? "vulkan" : palpate::chooseBackend(context, options);
  CLI::Option* named = command.get_option("--backend");
  named->clear();
  named->add_result(options.backend);
}

ServoResult play(ServoLoop& loop, Followers& followers, const TouchCommandOptions& options) {
  const StopBySignal stop;
  return loop.run(followers.begin(options.rate_Hz, options.realtime));
}

void touch(Context& context, const CLI::App& command, const TouchCommandOptions& options) {
  checkTouchOptions(options);
  for (const std::string* file : {&options.traceFile, &options.secondTraceFile, &options.trajectoryFile,
                                  &options.saveFile, &options.pictureFile, &options.logFile})
    Context::checkWritable(*file);
  std::error_code ignored;
  if (std::filesystem::equivalent(options.model.file, options.logFile, ignored))
    throw UsageError("--log: {} is the model itself", options.logFile);
  sayWhatIsLost(options.saveFile, context.log());
  const Model model = loadModel(context, options.model, estimateOn(options.backend));
  const Stylus stylus = stylusFor(context, model, options, options.stylus, options.path);
  std::optional<Stylus> second;
  if (!options.secondDevice.empty())
    second = stylusFor(context, model, options, secondStylus(options.stylus, options.secondDevice), options.secondPath);
  const auto brush = brushOptions(options, model.scale);
  if (brush)
    if (const std::string remark =
            tooSmallTool(options.toolRadius_mm, model.scale.toMm(model.spacing), "--tool-radius");
        !remark.empty())
      context.log().say("{}: {}", options.model.file, remark);
  const SurfaceOptions surface = surfaceOptions(model, options.backend);
  BackendOptions backendOptions = options.backend;
  backendOptions.realtime = options.realtime;
  backendOptions.secondHand = second.has_value();
  const auto backend = makeBackend(context, model, backendOptions, brush);
  auto* touchSide = dynamic_cast<TouchSide*>(backend.get());
  std::optional<Recording> recording;
  if (!options.logFile.empty())
    recording.emplace(context.log(), options.logFile, command, *backend, model, options, stylus);
  const bool journal = brush && backend->keepsEdits() && (!options.saveFile.empty() || options.undo > 0);
  Followers followers(context, model, *backend,
                      {.picture = !options.pictureFile.empty(),
                       .journal = journal || recording,
                       .undo_bytes = undoBytes(options),
                       .log = recording ? &recording->writer() : nullptr});

  std::optional<SecondHand> secondHand;
  if (second)
    secondHand.emplace(SecondHand{.device = *second->device,
                                  .law = ForceLaw(options.force, model.scale),
                                  .options = {.map = second->map, .passivity = second->passivity}});
  const double duration_s = std::max(stylus.duration_s, second ? second->duration_s : 0);
  std::optional<ShownTicks> shown;
  shown.emplace(context.log(), duration_s, recording ? &recording->tap() : nullptr);
  ServoLoop loop(*stylus.device, *backend, ForceLaw(options.force, model.scale),
                 {.rate_Hz = options.rate_Hz,
                  .duration_s = duration_s + 1 / options.rate_Hz,  // the path's end is a tick too
                  .realtime = options.realtime,
                  .map = stylus.map,
                  .passivity = stylus.passivity,
                  .stop = &stopRequested,
                  .recorder = &*shown},
                 secondHand);
  const ServoResult result = play(loop, followers, options);
  shown.reset();
  Outputs outputs;
  outputs.write([&] {
    if (!options.traceFile.empty()) writeTraceCsv(options.traceFile, result.trace);
  });
  outputs.write([&] {
    if (!options.secondTraceFile.empty()) writeTraceCsv(options.secondTraceFile, result.second->trace);
  });
  outputs.write([&] {
    if (!options.trajectoryFile.empty()) writeTrajectory(options.trajectoryFile, result.trace);
  });
  std::optional<StrokesTakenBack> back;
  try {
    backend->finish();
    followers.finish();
    if (options.undo > 0)
      back = takeBack(
          *backend, *followers.journal(), [&] { followers.catchUp(); }, options.undo, options.redo);
  } catch (const Error& error) {
    followers.stop();
    saveAndThrow(error, model, followers.journal(), options.saveFile);
  }
  outputs.write([&] {
    if (recording) recording->writer().finish(checksumOf(model.cloud.origin, followers.journal()->points()));
  });

  const Sculpted end = brush ? sculpted(model, *backend, followers.journal()) : Sculpted{};
  const auto bridged = backend->bridgeTimes_us();
  TouchReport report{.points = model.cloud.size(),
                     .backend = options.backend.backend,
                     .machine = backend->machine(),
                     .method = methodName(options.backend),
                     .build_us = backend->buildTime_us(),
                     .trace = summarize(result.trace),
                     .servo = servoReport(result),
                     .edit_us = summarize(backend->editTimes_us()),
                     .bridge_us = summarize({bridged.begin(), bridged.end()}),
                     .shortfalls = backend->shortfalls(),
                     .compactions = backend->compactions(),
                     .index = backend->indexWork(),
                     .movedPoints = end.edited,
                     .realtimePriority = result.realtimePriority,
                     .pacedByDevice = result.pacedByDevice,
                     .realtime = options.realtime,
                     .interrupted = stopRequested,
                     .edits = brush.has_value(),
                     .radius_mm = model.scale.toMm(surface.radius),
                     .cell_mm = model.scale.toMm(backend->cell()),
                     .spacing_mm = model.scale.toMm(model.spacing),
                     .noise_spacings = model.noise,
                     .mm_per_unit = model.scale.mm_per_unit,
                     .tool = options.backend.tool,
                     .toolPoints = backend->points().size(),
                     .error = backend->points().empty()
                                  ? contactError(result.trace, model, surface, backend->firstEditTime_s())
                                  : ContactError{},  // a proxy that stands for many lies nowhere
                     .back = back};
  if (result.second) report.second = secondReport(options.secondDevice, *result.second);
  if (stylus.recorded) report.recorded = compareForces(result.trace, *stylus.recorded);
  if (recording)
    report.log =
        LogReport{recording->writer().bytes(), recording->writer().lostTicks(), recording->writer().mergedEdits()};
  outputs.write([&] {
    if (!options.saveFile.empty()) saveKeeping(options.saveFile, end.cloud);
  });
  outputs.write([&] {
    if (options.pictureFile.empty()) return;
    // A back end without an edit log is drawn once, as it ended.
    if (options.edit == "paint" && !showsPaint(options.picture))
      context.log().say("{}: --color {} and --pass {} do not show what was painted; --color rgb does",
                        options.pictureFile, options.picture.color, options.picture.pass);
    std::optional<DrawnCloud> ended;
    if (!followers.drawn())
      ended.emplace(context.device(), brush ? end.cloud : model.cloud, DrawnOptions{.spacing = model.spacing});
    takePicture(context, model, ended ? *ended : *followers.drawn(), options.picture,
                result.trace.rows.empty() ? Overlays{}
                                          : overlaysOf(result.trace.rows.back(), model.cloud.origin,
                                                       boundsOf(model.cloud).longestSide(), brush),
                options.pictureFile);
  });
  if (options.backend.timePasses && touchSide) printPasses(context.tables(), touchSide->passes());
  printReport(context.tables(), report);
  outputs.write([&] { context.writeJson(toJson(report)); });
  if (result.deviceFailed) outputs.failed(result.fault);
  outputs.check();
  if (report.interrupted) throw Error("interrupted after {} ticks; what they gave is kept", report.trace.ticks);
  const std::uint64_t faults = std::max(report.trace.faultTicks, report.second ? report.second->trace.faultTicks : 0);
  if (faults) throw Error("{} ticks had no valid answer; their force was zero", faults);
}

}  // namespace

void addTouch(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand("touch", "the haptic loop, headless: follow a path, feel, edit, trace");
  auto options = std::make_shared<TouchCommandOptions>();
  addTouchOptions(*sub, *options);
  sub->footer(
      "The trace has the columns t_s (s), hip, proxy, normal (x, y, z; model units), force (N), penetration_mm, "
      "contact, "
      "neighbours, fresh (1: this tick's own answer), gpu_us, step_us (0 in virtual time). For a tool of many points, "
      "proxy - hip is the sum of the ways from the points to their proxies, each times its share of the stiffness; "
      "normal is their mean by force; and torque (x, y, z; about the HIP, mN m) follows.\n");
  sub->callback([&, sub, options] {
    command = [&context, sub, options] {
      chooseBackend(context, *sub, options->backend);
      touch(context, *sub, *options);
    };
  });
}

}  // namespace palpate
