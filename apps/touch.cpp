#include <csignal>
#include <thread>

#include "apps/picture.hpp"
#include "apps/touch_report.hpp"
#include "engine/cloud/ply_writer.hpp"
#include "haptics/builtin_path.hpp"
#include "haptics/path_device.hpp"
#include "haptics/servo_loop.hpp"

namespace palpate {

namespace {

// Picture sizes of the probe, mm on a model of 100 mm.
constexpr double kBallRadius_mm = 1.2, kDiscRadius_mm = 2.5, kArrow_mm_per_N = 15, kShaftRadius_mm = 0.5;
constexpr double kSightRate_Hz = 30;

struct TouchCommandOptions {
  ModelOptions model;
  PictureOptions picture;
  std::string path = "builtin:press", radius = "auto", wait, edit = "none";
  std::string traceFile, saveFile, pictureFile;
  // One way of each so far, named as a script would name it.
  std::string device = "path", backend = "vulkan", method = "fused", surface = "average", index = "rebuild";
  double penetration_mm = 2, rate_Hz = 1000, cell_mm = 0, grid = 0;
  double tau_mm = 0.5, beta = 0.1, toolRadius_mm = 6;
  bool realtime = false, printTick = false;
  ForceOptions force;
};

std::atomic<bool> stopRequested = false;  // what a signal handler may touch

Path pathFor(const TouchCommandOptions& options, const Model& model) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (options.path.starts_with(kBuiltin))
    return builtinPath(options.path.substr(kBuiltin.size()), model.cloud, model.scale, options.penetration_mm);
  return readPathCsv(options.path);
}

TouchOptions touchOptions(const TouchCommandOptions& options, const Model& model) {
  TouchOptions touch{.radius = supportRadius(options.radius, model)};
  if (options.cell_mm > 0) touch.cell = model.scale.toUnits(options.cell_mm);
  if (options.grid > 0) touch.cell = boundsOf(model.cloud).longestSide() / options.grid;
  if (options.edit == "push")
    touch.push = PushOptions{.tau = model.scale.toUnits(options.tau_mm),
                             .beta = options.beta,
                             .toolRadius = model.scale.toUnits(options.toolRadius_mm)};
  if (options.wait == "spin") touch.wait = Wait::spin;
  if (options.wait == "poll") touch.wait = Wait::poll;
  if (options.wait == "block") touch.wait = Wait::block;
  if (options.printTick) touch.timing = CommandList::Timing::passes;
  return touch;
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
  checkPictureOptions(options.picture);
  if (!options.saveFile.empty() && options.edit == "none") throw UsageError("--save: nothing changes with --edit none");
  if (options.picture.printFrame && options.pictureFile.empty()) throw UsageError("--print-frame: needs --picture");
  for (const std::string* file : {&options.traceFile, &options.saveFile, &options.pictureFile})
    Context::checkWritable(*file);
  const Model model = loadModel(context, options.model);
  PathDevice device(pathFor(options, model));
  const TouchOptions touchOf = touchOptions(options, model);
  ForceLaw law(options.force, model.scale);
  ServoOptions servo{.rate_Hz = options.rate_Hz,
                     .duration_s = device.path().duration_s() + 1 / options.rate_Hz,  // the path's end is a tick too
                     .realtime = options.realtime,
                     .stop = &stopRequested};
  TouchSide touchSide(context.device(), model.cloud, touchOf);
  std::unique_ptr<SightSide> sight;
  if (!options.pictureFile.empty())
    sight = std::make_unique<SightSide>(context.device(), model.cloud, touchSide.editLog());

  ServoLoop loop(device, touchSide, law, servo);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { stopRequested = true; });
  if (sight && options.realtime) sight->follow();
  const ServoResult result = loop.run(sight && !options.realtime ? sight->observer(options.rate_Hz) : TickObserver{});
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  if (!options.traceFile.empty()) writeTraceCsv(options.traceFile, result.trace);
  touchSide.finish();

  PointCloud sculpted;
  if (touchOf.push) sculpted = model.cloud;
  TouchReport report{.points = model.cloud.size(),
                     .gpu = context.device().name(),
                     .build_us = touchSide.buildTime_us(),
                     .trace = summarize(result.trace),
                     .edit_us = summarize(touchSide.editTimes_us()),
                     .shortfalls = touchSide.shortfalls(),
                     .movedPoints = touchOf.push ? touchSide.live().readBack(sculpted) : 0,
                     .realtimePriority = result.realtimePriority,
                     .realtime = options.realtime,
                     .interrupted = stopRequested,
                     .edits = touchOf.push.has_value(),
                     .radius_mm = model.scale.toMm(touchOf.radius),
                     .cell_mm = model.scale.toMm(1.0 / static_cast<double>(touchSide.hash().grid().inverseCell)),
                     .spacing_mm = model.scale.toMm(model.spacing),
                     .mm_per_unit = model.scale.mm_per_unit,
                     .error = contactError(result.trace, model, touchOf.radius, touchSide.firstEditTime_s())};
  if (!options.saveFile.empty()) writePly(options.saveFile, sculpted);
  if (sight)
    takePicture(context, model, sight->finish(), options.picture,
                result.trace.rows.empty() ? Overlays{} : overlaysOf(result.trace.rows.back(), model),
                options.pictureFile);
  if (options.printTick) printPasses(context.tables(), touchSide.passes());
  printReport(context.tables(), report);
  context.writeJson(toJson(report));
  if (result.deviceFailed) throw Error("{}", result.fault);
  if (report.interrupted) throw Error("interrupted after {} ticks; what they gave is kept", report.trace.ticks);
  if (report.trace.faultTicks)
    throw Error("{} ticks had no valid answer; their force was zero", report.trace.faultTicks);
}

void addWays(CLI::App& sub, TouchCommandOptions& options) {
  const auto way = [&](const char* name, std::string& value, const char* what) {
    sub.add_option(name, value, what)->check(CLI::IsMember({value}))->capture_default_str();
  };
  way("--device", options.device, "what moves the HIP: path, a scripted one");
  way("--backend", options.backend, "what answers: vulkan");
  way("--method", options.method, "how neighbours are found: fused, gather, surface and proxy in one dispatch");
  way("--surface", options.surface, "what the points define: average, weighted position and normal");
  way("--index", options.index, "how the index follows an edit: rebuild, whole and in the same tick");
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
  sub->add_option("--radius", options->radius, "support radius of the surface, mm, or auto (4 spacings)")
      ->capture_default_str();
  auto* cell = sub->add_option("--cell", options->cell_mm, "edge of a hash cell, mm (default: the support radius)")
                   ->check(positive());
  sub->add_option("--grid", options->grid, "hash cells along the longest side, instead of --cell")
      ->check(positive())
      ->excludes(cell);
  sub->add_option("--wait", options->wait, "for the GPU: spin, poll or block (default: by driver and cores)")
      ->check(CLI::IsMember({"spin", "poll", "block"}));
  addWays(*sub, *options);
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
  sub->add_flag("--print-tick", options->printTick, "list the passes of a tick with threads, bytes and GPU us");
  sub->callback([&, options] { command = [&context, options] { touch(context, *options); }; });
}

}  // namespace palpate
