#include <csignal>
#include <thread>

#include "apps/backend.hpp"
#include "apps/picture.hpp"
#include "apps/stylus.hpp"
#include "apps/touch_report.hpp"
#include "engine/cloud/ply_writer.hpp"
#include "haptics/builtin_path.hpp"
#include "haptics/servo_loop.hpp"

namespace palpate {

namespace {

// Picture sizes of the probe, mm on a model of 100 mm.
constexpr double kBallRadius_mm = 1.2, kDiscRadius_mm = 2.5, kArrow_mm_per_N = 15, kShaftRadius_mm = 0.5;
constexpr double kSightRate_Hz = 30;

struct TouchCommandOptions {
  ModelOptions model;
  BackendOptions backend;
  PictureOptions picture;
  StylusOptions stylus;
  std::string path = "builtin:press", edit = "none";
  std::string traceFile, saveFile, pictureFile;
  double penetration_mm = 2, rate_Hz = 1000;
  double tau_mm = 0.5, beta = 0.1, toolRadius_mm = 6;
  bool realtime = false;
  ForceOptions force;
};

std::atomic<bool> stopRequested = false;  // what a signal handler may touch

Path pathFor(const TouchCommandOptions& options, const Model& model) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (options.path.starts_with(kBuiltin))
    return builtinPath(options.path.substr(kBuiltin.size()), model.cloud, model.scale, options.penetration_mm);
  return readPathCsv(options.path);
}

std::optional<BrushOptions> pushOptions(const TouchCommandOptions& options, const ModelScale& scale) {
  if (options.edit != "push") return std::nullopt;
  return BrushOptions{
      .tau = scale.toUnits(options.tau_mm), .beta = options.beta, .toolRadius = scale.toUnits(options.toolRadius_mm)};
}

Overlays overlaysOf(const TraceRow& row, const Model& model) {
  const double unitsPer_mm = boundsOf(model.cloud).longestSide() / kDefaultLongestSide_mm;
  const auto units = [&](double mm) { return mm * unitsPer_mm; };
  Overlays overlays;
  overlays.hip = {row.hip - model.cloud.origin, units(kBallRadius_mm)};
  if (!row.contact) return overlays;
  const DVec3 proxy = row.proxy - model.cloud.origin;
  overlays.proxy = {proxy, row.normal, units(kDiscRadius_mm)};
  overlays.force = {proxy, row.force_N * units(kArrow_mm_per_N), units(kShaftRadius_mm)};
  return overlays;
}

// The sight side of a session: the drawn cloud follows the edit log, between ticks in virtual time and on a thread of
// its own against the wall clock. A failure there waits for finish(), since the hand goes first.
class SightSide {
 public:
  SightSide(Device& device, const PointCloud& cloud, EditLog& log) : drawn_(device, cloud), log_(log) {
    log.attachReader();
  }

  TickObserver observer(double rate_Hz) {
    const auto period = static_cast<std::uint64_t>(std::max(1.0, rate_Hz / kSightRate_Hz));
    return [this, period](const TraceRow&) {
      // Virtual time waits: no edit is left out because the picture is behind, not even one that moves every point.
      const bool full = log_.room() < 2 * std::uint64_t{drawn_.count()};
      if (++ticks_ % period == 0 || full) drawn_.catchUp(log_);
    };
  }
  void follow() {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      try {
        while (!stop.stop_requested()) {
          drawn_.catchUp(log_);
          std::this_thread::sleep_for(std::chrono::duration<double>(1 / kSightRate_Hz));
        }
      } catch (...) {
        failure_ = std::current_exception();
        log_.detachReader();  // the hand goes on without the picture
      }
    });
  }
  DrawnCloud& finish() {
    thread_ = {};
    if (failure_) std::rethrow_exception(failure_);
    drawn_.catchUp(log_);
    return drawn_;
  }

 private:
  DrawnCloud drawn_;
  EditLog& log_;
  std::uint64_t ticks_ = 0;
  std::exception_ptr failure_;
  std::jthread thread_;
};

void touch(Context& context, const TouchCommandOptions& options) {
  checkBackendOptions(options.backend);
  checkPictureOptions(options.picture);
  if (!options.saveFile.empty() && options.edit == "none") throw UsageError("--save: nothing changes with --edit none");
  if (options.picture.printFrame && options.pictureFile.empty()) throw UsageError("--print-frame: needs --picture");
  for (const std::string* file : {&options.traceFile, &options.saveFile, &options.pictureFile})
    Context::checkWritable(*file);
  const bool opensGpu = options.backend.backend == "vulkan" || !options.pictureFile.empty();
  const Model model = loadModel(context, options.model, opensGpu ? EstimateOn::gpu : EstimateOn::cpu);
  const Stylus stylus = makeStylus(options.stylus, pathFor(options, model), model.scale);
  const auto push = pushOptions(options, model.scale);
  const SurfaceOptions surface = surfaceOptions(model, options.backend);
  ForceLaw law(options.force, model.scale);
  ServoOptions servo{.rate_Hz = options.rate_Hz,
                     .duration_s = stylus.duration_s + 1 / options.rate_Hz,  // the path's end is a tick too
                     .realtime = options.realtime,
                     .map = stylus.map,
                     .passivity = stylus.passivity,
                     .stop = &stopRequested};
  BackendOptions backendOptions = options.backend;
  backendOptions.realtime = options.realtime;
  const auto backend = makeBackend(context, model, backendOptions, push);
  auto* touchSide = dynamic_cast<TouchSide*>(backend.get());
  std::unique_ptr<SightSide> sight;
  if (!options.pictureFile.empty() && touchSide)
    sight = std::make_unique<SightSide>(context.device(), model.cloud, touchSide->editLog());

  ServoLoop loop(*stylus.device, *backend, law, servo);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { stopRequested = true; });
  if (sight && options.realtime) sight->follow();
  const ServoResult result = loop.run(sight && !options.realtime ? sight->observer(options.rate_Hz) : TickObserver{});
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  if (!options.traceFile.empty()) writeTraceCsv(options.traceFile, result.trace);
  backend->finish();

  PointCloud sculpted;
  if (push) sculpted = model.cloud;
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
                     .movedPoints = push ? backend->readBack(sculpted) : 0,
                     .realtimePriority = result.realtimePriority,
                     .realtime = options.realtime,
                     .interrupted = stopRequested,
                     .edits = push.has_value(),
                     .radius_mm = model.scale.toMm(surface.radius),
                     .cell_mm = model.scale.toMm(backend->cell()),
                     .spacing_mm = model.scale.toMm(model.spacing),
                     .mm_per_unit = model.scale.mm_per_unit,
                     .error = contactError(result.trace, model, surface, backend->firstEditTime_s())};
  if (!options.saveFile.empty()) writePly(options.saveFile, sculpted);
  if (!options.pictureFile.empty()) {
    // A back end without an edit log is drawn once, as it ended.
    std::optional<DrawnCloud> ended;
    if (!sight) ended.emplace(context.device(), push ? sculpted : model.cloud);
    takePicture(context, model, sight ? sight->finish() : *ended, options.picture,
                result.trace.rows.empty() ? Overlays{} : overlaysOf(result.trace.rows.back(), model),
                options.pictureFile);
  }
  if (options.backend.timePasses && touchSide) printPasses(context.tables(), touchSide->passes());
  printReport(context.tables(), report);
  context.writeJson(toJson(report));
  if (result.deviceFailed) throw Error("{}", result.fault);
  if (report.interrupted) throw Error("interrupted after {} ticks; what they gave is kept", report.trace.ticks);
  if (report.trace.faultTicks)
    throw Error("{} ticks had no valid answer; their force was zero", report.trace.faultTicks);
}

void addForceOptions(CLI::App& sub, ForceOptions& force) {
  sub.add_option("--stiffness", force.stiffness_N_per_mm, "N/mm")->check(notNegative())->capture_default_str();
  sub.add_option("--damping", force.damping_N_s_per_mm, "N s/mm")->check(notNegative())->capture_default_str();
  sub.add_option("--max-force", force.maxForce_N,
                 "N; no force is ever larger (nor does it grow or turn faster than 600 N/s)")
      ->check(notNegative())
      ->capture_default_str();
}

void addEditOptions(CLI::App& sub, TouchCommandOptions& options) {
  sub.add_option("--edit", options.edit, "none, or push: the surface yields to a round tool")
      ->check(CLI::IsMember({"none", "push"}))
      ->capture_default_str();
  sub.add_option("--tau", options.tau_mm, "how deep the HIP may stand behind the proxy before the surface yields, mm")
      ->check(notNegative())
      ->capture_default_str();
  sub.add_option("--beta", options.beta, "share of the way to the tool's surface that a point goes per tick, 0 to 1")
      ->check(between(0, 1))
      ->capture_default_str();
  sub.add_option("--tool-radius", options.toolRadius_mm, "of the round tool, mm")
      ->check(positive())
      ->capture_default_str();
  sub.add_option("--save", options.saveFile,
                 "write the edited points, with all their other properties (faces and other elements are not kept)")
      ->type_name("OUT.ply");
}

}  // namespace

void addTouch(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand("touch", "the haptic loop, headless: follow a path, feel, edit, trace");
  auto options = std::make_shared<TouchCommandOptions>();
  addModelOptions(*sub, options->model);
  sub->add_option(
         "--path", options->path,
         "CSV under the header t_s,x,y,z (s, model units; linear in between; # comments), or builtin:press (straight "
         "down, and stays), slide (1 mm deep, 20 mm along), scan (25 taps), orbit (around, without touching)")
      ->capture_default_str();
  sub->add_option("--penetration", options->penetration_mm, "how deep builtin:press goes, mm")
      ->check(positive())
      ->capture_default_str();
  sub->add_option("--rate", options->rate_Hz, "ticks per second")->check(between(1, 10'000))->capture_default_str();
  sub->add_flag("--realtime", options->realtime, "against the wall clock (default: virtual time, as fast as it goes)");
  addStylusOptions(*sub, options->stylus);
  addBackendOptions(*sub, options->backend);
  addForceOptions(*sub, options->force);
  addEditOptions(*sub, *options);
  sub->add_option("--trace", options->traceFile, "one row per tick; in virtual time its two wall-clock columns are 0")
      ->type_name("FILE.csv");
  sub->add_option("--picture", options->pictureFile, "the model at the end, with HIP, proxy disc and force arrow")
      ->type_name("IMG.png");
  addPictureOptions(*sub, options->picture);
  sub->footer(
      "The trace has the columns t_s (s), hip, proxy, normal (x, y, z; model units), force (N), penetration_mm, "
      "contact, "
      "neighbours, fresh (1: this tick's own answer), gpu_us, step_us (0 in virtual time).\n");
  sub->add_flag("--print-tick", options->backend.timePasses,
                "list the passes of a tick with threads, bytes and GPU us");
  sub->callback([&, options] { command = [&context, options] { touch(context, *options); }; });
}

}  // namespace palpate
