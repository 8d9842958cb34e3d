// What the benches share: what they are told, the models that are measured, and how a measurement is repeated.
#pragma once

#include "apps/backend.hpp"
#include "apps/bounds.hpp"
#include "apps/plot.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/statistics.hpp"

namespace palpate {

/// What every bench may be told. Each takes those of the options that mean something to it, and has more of its own.
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
void addSubjectOptions(CLI::App& bench, BenchOptions& options);
CLI::Option* addBackendsOption(CLI::App& bench, BenchOptions& options, std::vector<std::string> choices);
void addMethodsOption(CLI::App& bench, BenchOptions& options, const std::string& what);
void addRepeatOptions(CLI::App& bench, BenchOptions& options);
void addRateOption(CLI::App& bench, BenchOptions& options);
void addFrictionOption(CLI::App& bench, BenchOptions& options);
void addPlotOption(CLI::App& bench, BenchOptions& options, const std::string& what);
/// One of several values or all, with commas between them; it begins as all that there are.
CLI::Option* addListOption(CLI::App& bench, const std::string& name, std::vector<std::string>& values,
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

/// Throws UsageError for a method that none of the back ends has.
void checkMethods(const BenchOptions& options);

/// A bench that is asked for alone, with a result of its own under its name: says which machines it runs on, measures,
/// writes what --json asks for, and plots it by `script` where --plot asks for that. Gives back what was measured.
Json measureAlone(Context& context, const BenchOptions& options, const std::string& name,
                  const std::function<Json()>& measure, PlotScript script = PlotScript::bench);

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
void addTimeBenches(CLI::App& bench, Context& context, Command& command);  ///< build, sort, query and step
/// Judges touch on surfaces that are known (apps/touch_judge.hpp).
void addTouchBench(CLI::App& bench, Context& context, Command& command);
/// What an edited step costs, against the points of the model and against those that the edit touches
/// (apps/edit_cost.hpp).
void addEditBench(CLI::App& bench, Context& context, Command& command);
/// What a mesh costs, pass by pass, whole and after an edit, and how far it is from shapes that are known.
void addMeshBench(CLI::App& bench, Context& context, Command& command);
/// What a picture costs, pass by pass, and how true it is to shapes that are known (apps/picture_judge.hpp).
void addSplatBench(CLI::App& bench, Context& context, Command& command);
/// How touch fares beside pictures that are drawn as fast as they go, and those beside it.
void addCoexistBench(CLI::App& bench, Context& context, Command& command);
/// What edits change that they may not, on models and on clouds that are uneven in the ways of real ones: strokes of
/// each brush, judged by what is known of the points before and after alone (engine/cloud/edit_judge.hpp).
void addLocalityBench(CLI::App& bench, Context& context, Command& command);

}  // namespace palpate
