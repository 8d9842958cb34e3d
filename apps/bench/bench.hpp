// What the benches share: their options, the models that are measured, and how a measurement is repeated.
#pragma once

#include "apps/bench/plot.hpp"
#include "apps/cli/backend.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/statistics.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

/// What every bench may be asked for. Each takes those of the options that mean something to it, and has more of its
/// own.
struct BenchOptions {
  std::vector<std::string> models, backends{"vulkan"}, methods;
  std::vector<std::int64_t> sizes;
  std::int64_t repeat = 200;
  double limit_s = 5;
  double rate_Hz = 1e6;
  std::string plotFile;
  BackendOptions backend;

  bool wants(std::string_view name) const;  ///< whether a back end is to be measured
};

/// Options that several benches take.
void addSubjectOptions(Options& bench, BenchOptions& options);
Option addBackendsOption(Options& bench, BenchOptions& options, std::vector<std::string> choices);
void addMethodsOption(Options& bench, BenchOptions& options, const std::string& what);
void addRepeatOptions(Options& bench, BenchOptions& options);
void addRateOption(Options& bench, BenchOptions& options);
void addFrictionOption(Options& bench, BenchOptions& options);
void addPlotOption(Options& bench, BenchOptions& options, const std::string& what);
/// One of several values or all, with commas between them; it begins as all that there are.
Option addListOption(Options& bench, const std::string& name, std::vector<std::string>& values,
                     const std::string& what);

/// Ticks per second of a stroke in real time: 1000, unless the options say otherwise.
double realtimeRate_Hz(const BenchOptions& options);

/// What is measured: a file, or a sculpture of so many points.
struct Subject {
  std::string name;
  Model model;
};
/// Makes one when it is its turn: a hundred million points are a large part of a machine's memory.
using SubjectMaker = std::function<Subject(Context&)>;
std::vector<SubjectMaker> subjectsOf(const BenchOptions& options);

/// What a session on a model is configured with: the options of its back end, and a brush where it is edited. Ticks are
/// in virtual time unless the options say otherwise.
SessionConfig sessionConfig(const BackendOptions& options, const std::optional<BrushConfig>& brush = {});
/// A session on a model, which outlives it: a hundred million points are there once. `journal`: SessionParts.
Session startSession(Context& context, const Model& model, const SessionConfig& config, bool journal = false);

/// How the back end finds neighbours, its own choice last.
std::vector<std::string> methodChoices(const Context& context, const std::string& backend);
/// Throws UsageError for a method that none of the back ends has.
void checkMethods(const Context& context, const BenchOptions& options);

/// Says which machine each back end that is measured runs on; by its name in what comes back.
Json sayMachines(Context& context, const BenchOptions& options);

/// A bench that is asked for alone, with a result of its own under its name: says which machines it runs on, measures,
/// writes what --json asks for, and plots it by `script` where --plot asks for that. Gives back what was measured.
Json measureAlone(Context& context, const BenchOptions& options, const std::string& name,
                  const std::function<Json()>& measure, PlotScript script = PlotScript::bench);

/// The quantiles of what was measured; null where nothing was.
Json summaryOf(const Summary& summary);

/// Repeats `once` as the options say: `repeat` times, or until the limit has passed with five samples at least.
template <class Once>
void repeatMeasurement(const BenchOptions& options, Once&& once) {
  constexpr std::int64_t kFewest = 5;
  const Stopwatch watch;
  for (std::int64_t i = 0; i < options.repeat; ++i) {
    if (options.limit_s > 0 && i >= kFewest && watch.elapsed_s() > options.limit_s) return;
    once(i);
  }
}

/// The benches: each file adds its subcommand to `bench`, or those that are measured together.
void addTimeBenches(Options& bench, Context& context, Command& command);  ///< build, sort, query and step
/// Judges touch on surfaces that are known (apps/bench/touch_judge.hpp).
void addTouchBench(Options& bench, Context& context, Command& command);
/// What an edited step costs, against the points of the model and against those that the edit touches
/// (apps/bench/edit_cost.hpp).
void addEditBench(Options& bench, Context& context, Command& command);
/// What a mesh costs, pass by pass, whole and after an edit, and how far it is from shapes that are known.
void addMeshBench(Options& bench, Context& context, Command& command);
/// What a picture costs, pass by pass, and how true it is to shapes that are known (apps/bench/picture_judge.hpp).
void addSplatBench(Options& bench, Context& context, Command& command);
/// How touch fares beside pictures that are drawn as fast as they go, and those beside it.
void addCoexistBench(Options& bench, Context& context, Command& command);
/// What depth frames cost that fuse into a map while it is touched, and how true that map is.
void addStreamBench(Options& bench, Context& context, Command& command);
/// What a step of water and sand costs, at sizes that are asked for.
void addMatterBench(Options& bench, Context& context, Command& command);
/// How long it takes until what one hand does to a shared cloud is felt by another one.
void addShareBench(Options& bench, Context& context, Command& command);
/// How fast files are read, of any format.
void addReadBench(Options& bench, Context& context, Command& command);
/// What edits change that they may not, on models and on clouds that are uneven in the ways of real ones: strokes of
/// each brush, judged by what is known of the points before and after alone (engine/cloud/edit_judge.hpp).
void addLocalityBench(Options& bench, Context& context, Command& command);

}  // namespace palpate
