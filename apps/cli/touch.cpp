#include "apps/cli/touch.hpp"

#include <algorithm>

#include "apps/cli/output.hpp"
#include "apps/cli/probe_overlays.hpp"
#include "apps/cli/progress.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "apps/cli/touch_results.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/io/saving.hpp"
#include "haptics/session/drawn_follower.hpp"
#include "haptics/session/session.hpp"
#include "haptics/sharing/ros.hpp"

namespace palpate {

namespace {

/// Writes the output files of a session: a failure of one file does not prevent the others.
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
  /// Throws Error that names all failures.
  void check() const {
    if (!failures_.empty()) throw Error("{}", failures_);
  }

 private:
  std::string failures_;
};

/// After a failure of the back end, `error`: saves the points of the history and throws.
[[noreturn]] void saveAndThrow(const std::exception& error, Session& session, const std::string& saveFile) {
  if (!session.pointHistory() || saveFile.empty()) throw;
  saveKeeping(saveFile, session.sculpted().cloud);
  throw Error("{}; {} contains the last known points", error.what(), saveFile);
}

std::vector<HandSource> openHands(Context& context, const Model& model, const SessionConfig& config) {
  const StopBySignal stop;  // a device may have to be calibrated by hand
  std::vector<HandSource> hands;
  hands.reserve(config.hands.size());
  for (const HandConfig& hand : config.hands)
    hands.push_back(openHand(
        hand, {.model = model, .rate_Hz = config.rate_Hz, .log = context.log(), .stop = &StopBySignal::requested()}));
  return hands;
}

/// Reports of the hands after the first.
std::vector<FurtherHandReport> reportsOf(const std::vector<FurtherHand>& hands, const ServoResult& result) {
  std::vector<FurtherHandReport> reports;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const HandResult& felt = result.hands[i + 1];
    reports.push_back({.device = hands[i].device, .trace = summarize(felt.trace), .counts = felt.counts});
  }
  return reports;
}

/// Successive stages of the start.
class StartStages {
 public:
  /// Records the stage that has just ended.
  void ended(std::string_view name) {
    const double now_s = watch_.elapsed_s();
    add(name, now_s - std::exchange(last_s_, now_s));
  }
  void add(std::string_view name, double time_s) { stages_.push_back({name, time_s}); }
  const std::vector<StartStage>& all() const { return stages_; }

 private:
  Stopwatch watch_;
  double last_s_ = 0;
  std::vector<StartStage> stages_;
};

/// Updates the progress bar with each tick, and records the time of the first one.
class ShownTicks final : public TickRecorder {
 public:
  /// `next`: recorder that is also notified of each tick; null: none.
  ShownTicks(Log& log, double duration_s, TickRecorder* next)
      : progress_(log, "touch"), duration_s_(std::max(duration_s, 1e-9)), next_(next) {}
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override {
    if (next_) next_->ticked(row, device);
    if (!first_s_) first_s_ = since_.elapsed_s();
    progress_.set(row.time_s / duration_s_);
  }
  /// Time from the beginning of the loop.
  std::optional<double> first_s() const { return first_s_; }

 private:
  Progress progress_;
  double duration_s_;
  TickRecorder* next_;
  Stopwatch since_;
  std::optional<double> first_s_;
};

/// With `auto`, --gpu and --validate mean that GPU, even a software driver.
ChosenBackend chosenBackend(const Context& context, const BackendOptions& options) {
  const bool means = options.backend == "auto" && options.method != "direct" && context.asksForGpu();
  return means ? ChosenBackend{"vulkan"} : chooseBackend(context, options);
}

/// Maker of the drawn cloud that follows the session, if the answering GPU also draws it. It sets `made`.
std::vector<FollowerMaker> sightFor(Context& context, const std::string& pictureFile, const SessionConfig& config,
                                    DrawnFollower*& made) {
  if (pictureFile.empty() || config.backend.name != "vulkan") return {};
  return {[&](const Model& model, TouchBackend& backend) {
    auto follower = std::make_unique<DrawnFollower>(context.device(), model, backend);
    made = follower.get();
    return follower;
  }};
}

TouchReport reportOf(Session& session, const ServoResult& result, const SculptedCloud& end) {
  const Model& model = session.model();
  const SessionConfig& config = session.config();
  TouchBackend& touch = session.backend();
  const BackendReport backend = touch.report();
  TouchReport report{.points = model.cloud.size(),
                     .backend = config.backend.name,
                     .machine = session.machine(),
                     .method = session.method(),
                     .build_us = backend.build_us,
                     .trace = summarize(result.trace()),
                     .servo = servoReport(result),
                     .edit_us = summarize({backend.editTimes_us.begin(), backend.editTimes_us.end()}),
                     .bridge_us = summarize({backend.bridgeTimes_us.begin(), backend.bridgeTimes_us.end()}),
                     .shortfalls = backend.shortfalls,
                     .compactions = backend.compactions,
                     .index = backend.index,
                     .movedPoints = end.edited,
                     .blocked = session.blocked(),
                     .realtimePriority = result.realtimePriority,
                     .pacedByDevice = result.pacedByDevice,
                     .realtime = config.realtime,
                     .interrupted = StopBySignal::requested(),
                     .edits = config.brush.has_value() && !config.model.matter,
                     .stiffness_N_per_mm = config.force.stiffness_N_per_mm,
                     .radius_mm = model.scale.toMm(session.surface().radius),
                     .cell_mm = model.scale.toMm(backend.cell),
                     .spacing_mm = model.scale.toMm(model.spacing),
                     .noise_spacings = model.noise,
                     .mm_per_unit = model.scale.mm_per_unit,
                     .longestSide = model.shownBounds().longestSide(),
                     .toolPoints = touch.points(0).size()};
  report.frames = session.playCounts();
  if (const SharedPresence* const presence = session.presence()) {
    report.cameras = presence->cameras().size();
    report.others = presence->hands();
  }
  if (model.far()) {
    report.points = model.extent()->points;
    report.far = FarReport{.counts = model.far()->counts(), .ticks = session.unknownTicks()};
  }
  if (config.model.matter)
    report.matter = MatterReport{.scene = config.model.matter->report(),
                                 .isSoft = config.model.matter->isSoft(),
                                 .dropped_s = session.simulation()->dropped_s(),
                                 .advances = session.simulation()->advances(),
                                 .duration_s = durationOf(result.trace()),
                                 .holds = session.simulation()->surfaceHolds(),
                                 .ports = session.simulation()->portEnergies()};
  if (touch.shapeStrokes() && config.brush) report.shape = session.strokes();
  // Not for tools with many points, whose proxy is a mean; not in real time for a motion, whose frames are older than
  // the poses; not for streams, of which only the first frame is known here; not for matter, which has no surface.
  if (touch.points(0).empty() && !model.far() && !config.model.stream && !config.model.matter &&
      !(config.motion && config.realtime))
    report.error =
        contactError(result.trace(), model, session.surface(), backend.firstEdit_s, rigidMotion(config, model));
  return report;
}

void drawEnd(Context& context, const TouchCommandOptions& options, const Session& session, DrawnFollower* followed,
             const PointCloud& cloud, const Trace& trace) {
  if (options.edit == "paint" && !showsPaint(options.picture))
    context.log().say("{}: --color-by {} and --pass {} do not show what was painted; --color-by rgb does",
                      options.pictureFile, options.picture.color.by, options.picture.pass);
  const Model& model = session.model();
  HeldTool tool;
  if (session.config().brush) tool.brush = brushOptions(*session.config().brush, model.scale);
  tool.ballRadius = model.ballRadius();
  // Points of a back end that is not followed are drawn once, in their final state.
  std::optional<DrawnCloud> ended;
  if (!followed) ended.emplace(context.device(), cloud, DrawnOptions{.spacing = model.spacingOfDiscs()});
  const History* const history = session.pointHistory();
  PicturedPoints points{.cloud = followed ? model.cloud : cloud, .states = {}};
  if (followed && history) points.states = history->points();
  takePicture(context, model, points, followed ? followed->drawn() : *ended, options.picture,
              trace.rows.empty()
                  ? Overlays{}
                  : overlaysOf(trace.rows.back(), model.cloud.origin, model.shownBounds().longestSide(), tool),
              PictureFiles{options.pictureFile, {options.pictureFile}});
}

/// Checks the output files before the session.
void checkOutputs(Context& context, const TouchCommandOptions& options, const std::vector<FurtherHand>& hands) {
  for (const auto& [file, kind] :
       {std::pair{&options.traceFile, Output::only}, std::pair{&options.trajectoryFile, Output::only},
        std::pair{&options.saveFile, Output::points}, std::pair{&options.pictureFile, Output::picture},
        std::pair{&options.logFile, Output::only}})
    checkOutput(*file, kind);
  for (const FurtherHand& hand : hands) checkOutput(hand.traceFile, Output::only);
  sayWhatIsLost(options.saveFile, context.log());
}

/// Throws if the model lacks points, or refuses what the options ask for.
void checkModel(const TouchCommandOptions& options, const SessionConfig& config, const Model& model) {
  if (model.cloud.empty() && !model.far())
    throw FileError(options.model.file, "contains no points; there is nothing to touch");
  const Abilities can(modelKindOf(config, model));
  if (!options.saveFile.empty()) can.require(Action::save, "--save");
  if (options.undo.undo > 0) can.require(Action::undo, "--undo");
  if (options.layer->given()) can.require(Action::layer, "--layer-strength");
  if (!options.logFile.empty()) can.require(Action::record, "--log");
}

Model openModel(Context& context, const TouchCommandOptions& options, const SessionConfig& config,
                const BackendKind& kind) {
  return loadModel(config.model, {.log = context.log(),
                                  .threads = context.threads(),
                                  .estimate = kind.normalEstimator(),
                                  .join = joiningHand(options.join.hand),
                                  .fetch = rosFetcher(options.join.network),
                                  .watch = rosWatcher(options.join.network, context.threads()),
                                  .exceeds = context.exceedsMemory()});
}

void warnOfSmallBrush(Context& context, const TouchCommandOptions& options, const Model& model) {
  const std::string remark =
      remarkOnSmallBrush(options.brush.radius_mm, model.scale.toMm(model.spacing), "--brush-radius",
                         [](double mm) { return fmt::format("{:.3g} mm", mm); });
  if (!remark.empty()) context.log().say("{}: in the hand, {}", options.model.file, remark);
}

SessionParts partsOf(Context& context, const TouchCommandOptions& options, const SessionConfig& config,
                     DrawnFollower*& sight) {
  const bool isAsked =
      !options.saveFile.empty() || options.undo.undo > 0 || !options.masks.empty() || options.layer->given();
  const bool keeps = config.brush && isAsked;
  return {.backend = context.backends().named(config.backend.name),
          .threads = context.threads(),
          .keepsPoints = keeps || !options.logFile.empty(),
          .undo = {undoBytes(config.undo)},
          .log = &context.log(),
          .followers = sightFor(context, options.pictureFile, config, sight)};
}

ServoResult run(Context& context, Session& session, std::span<const OpenHand> hands, TickRecorder* publisher,
                StartStages& start) {
  ShownTicks shown(context.log(), session.durationOf(hands), publisher);
  ServoResult ran = session.run(hands, {.stop = &StopBySignal::requested(), .recorder = &shown});
  if (const auto first_s = shown.first_s()) start.add("first answer", *first_s);
  return ran;
}

void writeTraces(Outputs& outputs, const TouchCommandOptions& options, const std::vector<FurtherHand>& others,
                 const ServoResult& result) {
  const auto write = [&](const std::string& file, const Trace& trace) {
    outputs.write([&] {
      if (!file.empty()) writeTraceCsv(file, trace);
    });
  };
  write(options.traceFile, result.trace());
  for (std::size_t i = 0; i < others.size(); ++i) write(others[i].traceFile, result.hands[i + 1].trace);
  outputs.write([&] {
    if (!options.trajectoryFile.empty()) writeTrajectory(options.trajectoryFile, result.trace());
  });
}

/// Ends the edits of the session, undoes strokes, and gives the others their strength. After a failure of the back end:
/// saveAndThrow().
std::optional<UndoneStrokes> finish(Session& session, const TouchCommandOptions& options) {
  try {
    session.finish();
    std::optional<UndoneStrokes> undone;
    if (options.undo.undo > 0) {
      undone = session.undo(options.undo.undo, options.undo.redo);
      session.settleShared(kSharedPatience_s);
    }
    if (options.layer->given() && session.scene().layers[0].attributes.strokeLayers().size() > 0)
      session.setStrokeLayer(0, {.name = "strokes", .strength = options.layerStrength}, false);
    return undone;
  } catch (const std::exception& error) {  // also where memory has run out
    session.abandonEdits();
    saveAndThrow(error, session, options.saveFile);
  }
}

/// Reports the exchange with the other participants, and as a failure what they lack.
SharedCounts checkShared(Outputs& outputs, Session& session, const TouchCommandOptions& options) {
  SharedCounts counts = session.shared()->counts();
  outputs.write([&] { session.checkFollower(); });
  if (!counts.delivered)
    outputs.failed(fmt::format(
        "'{}' has not received all edits of this hand; {}", session.config().model.file,
        options.saveFile.empty() ? "they are lost (--save keeps them)" : options.saveFile + " contains them"));
  return counts;
}

/// Throws if the session was interrupted, or if ticks had no valid answer. `planned_s`: duration without an
/// interruption; 0: unlimited.
void checkTicks(const TouchReport& report, const Trace& trace, double planned_s) {
  if (report.interrupted)
    throw Error("interrupted after {}{}; their results are kept", counted(report.trace.ticks, "tick"),
                planned_s > 0 ? fmt::format(", {:.3f} of {:.6g} s", durationOf(trace), planned_s) : "");
  std::uint64_t faults = report.trace.faultTicks;
  for (const FurtherHandReport& hand : report.hands) faults = std::max(faults, hand.trace.faultTicks);
  if (faults) throw Error("{} ticks had no valid answer; their force was zero", faults);
}

void addHands(TouchReport& report, const TouchCommandOptions& options, const std::vector<FurtherHand>& others,
              const HandSource& first, const ServoResult& result) {
  report.tool = options.backend.tool;
  report.remembered = first.remembered.inWords();
  report.hands = reportsOf(others, result);
  if (first.recorded) report.recorded = compareForces(result.trace(), *first.recorded);
}

LogReport reportOf(const SessionWriter& log) { return {log.bytes(), log.lostTicks(), log.mergedEdits()}; }

void touch(Context& context, const TouchCommandOptions& options, bool isOpen) {
  StartStages start;
  SessionConfig config = sessionConfig(options, context.log());
  const BackendKind& kind = context.backends().named(config.backend.name);
  validate(config);
  kind.check(config);
  checkTouchOptions(options, kind.capabilities());
  const std::vector<FurtherHand> others = furtherHands(options.hands, options.hand, config.realtime);
  checkOutputs(context, options, others);
  // A picture that cannot be drawn is an error now, and not after the session.
  if (!options.pictureFile.empty() && config.backend.name != "vulkan") context.device();
  Model model = openModel(context, options, config, kind);
  start.ended("model");
  checkModel(options, config, model);
  if (isOpen && config.realtime) {
    config.backend.name = soonerBackend(context, config, model);
    start.ended("choice of the back end");
  }
  std::optional<RosHand> ros;
  if (!options.join.ros.name.empty())
    ros.emplace(options.join.ros.publishing(options.join.network, model.scale.mm_per_unit), options.join.ros.rate_Hz);
  const std::vector<HandSource> sources = openHands(context, model, config);
  std::vector<OpenHand> hands;
  hands.reserve(sources.size());
  for (const HandSource& source : sources) hands.push_back(source.hand());
  if (!options.stiffness->given())
    config.force.stiffness_N_per_mm =
        sources.front().remembered.stiffness_N_per_mm.value_or(config.force.stiffness_N_per_mm);
  start.ended("hands");
  if (config.brush) warnOfSmallBrush(context, options, model);
  DrawnFollower* sight = nullptr;
  Session session(config, std::move(model), partsOf(context, options, config, sight));
  setMasks(context, options.masks, session);
  if (options.layer->given()) session.setStrokeLayer(0, {.name = "strokes"}, true);
  if (!options.logFile.empty())
    session.record(options.logFile, hands.front(),
                   [&context](const std::string& what) { context.log().say("{}", what); });
  if (SessionRecording* const begun = session.recording(); begun && !begun->writer().keptAs().empty())
    context.log().say("{}: the existing log is kept as {}", options.logFile, begun->writer().keptAs().string());
  start.ended("session");
  const StopBySignal stop;  // until all results are written
  const ServoResult result = run(context, session, hands, ros ? &*ros : nullptr, start);
  Outputs outputs;
  std::optional<RosHand::Counts> heard;
  outputs.write([&] {
    if (ros) heard = ros->finish();
  });
  writeTraces(outputs, options, others, result);
  const std::optional<UndoneStrokes> undone = finish(session, options);
  SessionRecording* const recording = session.recording();
  outputs.write([&] {
    if (recording) recording->finish(session.endChecksum());
  });

  const bool changes = config.brush || config.moves() || session.shared() || session.far();
  const SculptedCloud end = changes ? session.sculpted() : SculptedCloud{};
  TouchReport report = reportOf(session, result, end);
  report.start = start.all();
  report.unit = unitOf(session.model().cloud, options.picture.look);
  report.ros = heard;
  report.back = undone;
  addHands(report, options, others, sources.front(), result);
  if (session.shared()) report.shared = checkShared(outputs, session, options);
  if (recording) report.log = reportOf(recording->writer());
  outputs.write([&] {
    if (options.saveFile.empty()) return;
    std::string lost;
    saveKeeping(options.saveFile, end.cloud, {.notKept = &lost});
    for (const std::string& remark : {end.remark, lost})
      if (!remark.empty()) context.log().say("{}: {}", options.saveFile, remark);
    report.atServer = session.saveAtServer();
    if (report.atServer) context.log().say("{}: {}", options.join.name, inWords(*report.atServer));
  });
  outputs.write([&] {
    if (options.pictureFile.empty()) return;
    if (StopBySignal::requested())
      return context.log().say("{}: not drawn, because the session was interrupted", options.pictureFile);
    session.checkFollower();
    drawEnd(context, options, session, sight, changes ? end.cloud : session.model().cloud, result.trace());
  });
  if (options.backend.timePasses) printPasses(context.tables(), session.backend().passes());
  printReport(context.tables(), report);
  outputs.write([&] { context.writeJson(toJson(report)); });
  if (result.deviceFailed) outputs.failed(result.fault);
  outputs.check();
  checkTicks(report, result.trace(), session.durationOf(hands));
}

}  // namespace

void addTouch(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("touch", "run the haptic loop headless: follow a path, feel, sculpt, write a trace");
  auto options = std::make_shared<TouchCommandOptions>();
  addTouchOptions(sub, *options);
  sub.footer(
      "Columns of the trace: t_s (s), hip, proxy, normal (x, y, z; model units), force (N), "
      "penetration_mm, contact, neighbours, fresh (1: answer to the pose of this tick), gpu_us, "
      "step_us (both 0 in virtual time). With a tool of many points, proxy - hip is the sum of "
      "their displacements weighted by their share of the stiffness, normal their mean weighted by "
      "force, and the columns torque (x, y, z; about the HIP, mN m) follow.\n");
  sub.whenNamed([&, options] {
    command = [&context, options] {
      const ChosenBackend chosen = chosenBackend(context, options->backend);
      options->backend.backend = chosen.name;
      touch(context, *options, chosen.isOpen);
    };
  });
}

}  // namespace palpate
