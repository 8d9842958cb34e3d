// Shared by the benches: their options, the models they measure, and the repetition of a measurement.
#pragma once

#include "apps/bench/tables.hpp"
#include "apps/cli/backend.hpp"
#include "apps/cli/results.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/statistics.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/vulkan_backend.hpp"

namespace palpate {

/// Options of the measured back end, with options of the engine that users do not have.
struct BenchBackend : BackendOptions {
  std::string sort = "counting", wait;  ///< empty: by driver and cores
  double grid = 0;                      ///< cells along the longest side; 0: as `cell_mm`
  std::optional<std::uint32_t> spareSlots;
};

/// Options of the benches. Each bench accepts those that apply to it, and has more of its own.
struct BenchOptions {
  std::vector<std::string> models, backends{"vulkan"}, methods;
  std::vector<std::int64_t> sizes;
  std::int64_t repeat = 200;
  double limit_s = 5;
  double rate_Hz = 1e6;
  std::string plotFile;
  BenchBackend backend;

  bool wants(std::string_view name) const;  ///< whether a back end is to be measured
};

/// Options that several benches take.
void addSubjectOptions(Options& bench, BenchOptions& options);
Option addBackendsOption(Options& bench, BenchOptions& options, std::vector<std::string> choices);
void addMethodsOption(Options& bench, BenchOptions& options, const std::string& what);
void addRepeatOptions(Options& bench, BenchOptions& options);
void addRateOption(Options& bench, BenchOptions& options);
/// Layout and build of the index, and the wait for the GPU.
void addEngineOptions(Options& bench, BenchBackend& backend);
void addFrictionOption(Options& bench, BenchOptions& options);
void addPlotOption(Options& bench, BenchOptions& options, const std::string& what);
/// A comma-separated list of the values in `values`, which are also its default.
Option addListOption(Options& bench, const std::string& name, std::vector<std::string>& values,
                     const std::string& what);

/// Ticks per second of a stroke in real time: 1000, unless the options say otherwise.
double realtimeRate_Hz(const BenchOptions& options);

/// The model under test: a file, or a sculpture with a given number of points.
struct Subject {
  std::string name;
  Model model;
};
/// Makes a subject only when it is measured: a hundred million points fill a large part of a machine's memory.
using SubjectMaker = std::function<Subject(Context&)>;
std::vector<SubjectMaker> subjectsOf(const BenchOptions& options);

/// Options of a session that are not of its back end.
struct BenchSession {
  std::optional<BrushConfig> brush = {};  ///< if the model is edited
  double rate_Hz = SessionConfig{}.rate_Hz;
  bool keepsPoints = false;      ///< SessionParts
  std::uint64_t undo_bytes = 0;  ///< memory of its history
};
/// A session on a model, which must outlive it: a hundred million points are not copied. Ticks are in virtual time
/// unless the options say otherwise.
Session startSession(Context& context, const Model& model, const BenchBackend& options, const BenchSession& more = {});
/// A session's configuration with these options.
SessionConfig configOn(const Model& model, const BenchBackend& options);
/// Throws UsageError for options that the back end does not support; before anything is loaded.
void checkBackend(const Context& context, const BenchBackend& options);
/// The surface and its support radius, and the grid, according to the options.
SurfaceOptions surfaceOptions(Context& context, const Model& model, const BackendOptions& options);
HashGrid gridFor(Context& context, const Model& model, const BenchBackend& options);

/// The back end's methods of finding neighbours, its default last.
std::vector<std::string> methodChoices(const Context& context, const std::string& backend);
/// Throws UsageError for a method that no measured back end offers.
void checkMethods(const Context& context, const BenchOptions& options);

/// Prints the machine of each measured back end. Returns how a result was made: the command, the day and the version,
/// and the machines by back end name.
Json describeRun(Context& context, const BenchOptions& options);

/// Keeps the GPU that is measured busy for a second: an idle one runs at a sixth of its usual clock, and needs 0.7 s to
/// reach it. Called before each size that is measured, since making a model leaves the GPU idle. Nothing on a CPU.
void warmUp(Context& context, const BenchOptions& options);

/// Runs a bench whose result has no other beside it: prints its machines, warms up, measures, writes --json, and plots
/// with `script` for --plot. Returns the measurements.
Json measureAlone(Context& context, const BenchOptions& options, const std::string& name,
                  const std::function<Json()>& measure, PlotScript script = PlotScript::bench);
/// The command of such a bench: it measures with `measure(context, *options)`.
template <class Its>
Command measuringAlone(Context& context, const std::shared_ptr<Its>& options, const std::string& name,
                       Json (*measure)(Context&, const Its&), PlotScript script = PlotScript::bench) {
  return [&context, options, name, measure, script] {
    measureAlone(
        context, *options, name, [&] { return measure(context, *options); }, script);
  };
}

/// The quantiles of the samples; null without samples.
Json summaryOf(const Summary& summary);

/// The value of a row that is a summary.
template <auto member>
std::optional<Json> quantiles(decltype(ownerOf(member)) report) {
  return summaryOf(std::invoke(member, report));
}

/// Repeats `once` `repeat` times, or until the time limit has passed and at least five samples exist.
template <class Once>
void repeatMeasurement(const BenchOptions& options, Once&& once) {
  constexpr std::int64_t kFewest = 5;
  const Stopwatch watch;
  for (std::int64_t i = 0; i < options.repeat; ++i) {
    if (options.limit_s > 0 && i >= kFewest && watch.elapsed_s() > options.limit_s) return;
    once(i);
  }
}

/// Appends the keys of describeRun().
void listRun(std::vector<ResultFacts>& all, const std::string& bench);
/// Appends the results of a bench that runs alone: their keys begin with its name.
template <class Rows>
void listAlone(std::vector<ResultFacts>& all, std::string_view name, std::string_view before, const Rows& rows) {
  listResults(all, fmt::format("bench {}", name), fmt::format("{}{}", name, before), rows);
}

/// The keys of the results of each bench.
void listTimeResults(std::vector<ResultFacts>& all);
void listTouchBenchResults(std::vector<ResultFacts>& all);
void listEditBenchResults(std::vector<ResultFacts>& all);
void listMeshBenchResults(std::vector<ResultFacts>& all);
void listSplatBenchResults(std::vector<ResultFacts>& all);
void listCoexistBenchResults(std::vector<ResultFacts>& all);
void listStreamBenchResults(std::vector<ResultFacts>& all);
void listStrokesBenchResults(std::vector<ResultFacts>& all);
void listMatterBenchResults(std::vector<ResultFacts>& all);
void listReadBenchResults(std::vector<ResultFacts>& all);
void listSelectBenchResults(std::vector<ResultFacts>& all);
void listShareBenchResults(std::vector<ResultFacts>& all);

/// The benches: each file adds its subcommand to `bench`; those measured together share one function.
void addTimeBenches(Options& bench, Context& context, Command& command);  ///< build, sort, query and step
/// Judges touch on known surfaces (apps/bench/touch_judge.hpp).
void addTouchBench(Options& bench, Context& context, Command& command);
/// Cost of an edited step, against the number of points in the model and the number that the edit touches
/// (apps/bench/edit_cost.hpp).
void addEditBench(Options& bench, Context& context, Command& command);
/// Cost of a mesh, per pass, complete and after an edit, and its deviation from known shapes.
void addMeshBench(Options& bench, Context& context, Command& command);
/// Cost of a picture, per pass, and its accuracy on known shapes (apps/bench/picture_judge.hpp).
void addSplatBench(Options& bench, Context& context, Command& command);
/// Touch beside pictures that are drawn as fast as possible, and those pictures beside touch.
void addCoexistBench(Options& bench, Context& context, Command& command);
/// Cost of depth frames that are fused into a map while it is touched, and the map's accuracy.
void addStreamBench(Options& bench, Context& context, Command& command);
/// Cost of a step of water, sand and soft bodies, at given sizes.
void addMatterBench(Options& bench, Context& context, Command& command);
/// Time until one hand's edit of a shared cloud is felt by another hand.
void addShareBench(Options& bench, Context& context, Command& command);
/// Reading speed of files in any format.
void addReadBench(Options& bench, Context& context, Command& command);
/// Cost of selecting and cleaning points; apps/bench/select_peers.py measures Open3D beside it.
void addSelectBench(Options& bench, Context& context, Command& command);
/// Random strokes of every brush, half of them on thin parts, folds and borders, judged by the points before and after
/// (engine/study/stroke_judge.hpp).
void addStrokesBench(Options& bench, Context& context, Command& command);

}  // namespace palpate
