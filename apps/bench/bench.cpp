#include "apps/bench/bench.hpp"

#include <fmt/chrono.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "apps/cli/output.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

Subject loadSubject(Context& context, const std::string& file, EstimateOn where) {
  Subject subject{std::filesystem::path(file).stem().string(), loadModel(context, {.file = file}, where)};
  subject.model.wideSpacing = subject.model.spacing;  // every back end gets the same radius
  subject.model.noise = 0;
  return subject;
}

Subject makeSubject(Context& context, std::size_t count) {
  const auto shape = makeShape("sculpture");
  Subject subject{.name = "sculpture"};
  subject.model.cloud = sampleShape(*shape, {.count = count, .threads = context.threads()});
  subject.model.scale = {1};
  subject.model.spacing = meanSpacing(subject.model.cloud, context.threads());
  return subject;
}

}  // namespace

SessionConfig configOn(const Model& model, const BenchBackend& options) {
  SessionConfig config;
  setBackend(config, options);
  if (options.grid > 0) config.index.cell_mm = model.scale.toMm(boundsOf(model.cloud).longestSide() / options.grid);
  return config;
}

bool BenchOptions::wants(std::string_view name) const { return std::ranges::find(backends, name) != backends.end(); }

void addSubjectOptions(Options& bench, BenchOptions& options) {
  bench.add("--models,--model", options.models, cloudFormats().namesRead() + " files").typeName("FILE...");
  bench.add("--sizes", options.sizes, "numbers of points; a sculpture is generated with each")
      .check(wholeBetween(1, 2e9))
      .typeName("N...");
}

Option addBackendsOption(Options& bench, BenchOptions& options, std::vector<std::string> choices) {
  return bench.add("--backend", options.backends, "back end; several are measured one after another")
      .check(oneOf(std::move(choices)))
      .separatedBy(',')
      .showDefault();
}

void addMethodsOption(Options& bench, BenchOptions& options, const std::string& what) {
  bench.add("--method", options.methods, what).separatedBy(',');
}

void addRepeatOptions(Options& bench, BenchOptions& options) {
  bench.add("--repeat", options.repeat, "repetitions of each measurement")
      .check(wholeBetween(1, bounds::kMaxCount))
      .showDefault();
  bench.add("--limit", options.limit_s, "time limit of one measurement, s, but at least 5 repetitions; 0: no limit")
      .check(between(0, bounds::kLongest_s))
      .showDefault();
}

void addRateOption(Options& bench, BenchOptions& options) {
  bench.add("--rate", options.rate_Hz, "maximum ticks per second").check(between(1e-3, 1e9)).showDefault();
}

void addEngineOptions(Options& bench, BenchBackend& backend) {
  const Option cell = addIndexOptions(bench, backend);
  bench
      .add("--sort", backend.sort,
           "sort of the index: counting (falls back to radix for crowded buckets), radix, or radix-lookback (half the "
           "memory traffic of radix)")
      .check(oneOf(namesOf(kSortMethods)))
      .showDefault();
  bench
      .add("--wait", backend.wait,
           "how the CPU waits for the GPU: spin, poll or block (default: depends on driver and core count)")
      .check(oneOf(namesOf(kWaits)));
  bench.add("--grid", backend.grid, "hash cells along the longest side, in place of --cell")
      .check(between({.min = 1, .max = 1e6, .orZero = true}))
      .excludes(cell);
}

void addFrictionOption(Options& bench, BenchOptions& options) {
  bench.add("--friction", options.backend.friction, "friction coefficient of the proxy")
      .check(between(0, bounds::kMaxFriction))
      .showDefault();
}

void addPlotOption(Options& bench, BenchOptions& options, const std::string& what) {
  bench.add("--plot", options.plotFile, what + " (needs matplotlib)").typeName("IMG.png").writes(Writes::replacing);
}

Option addListOption(Options& bench, const std::string& name, std::vector<std::string>& values,
                     const std::string& what) {
  return bench.add(name, values, what).check(oneOf(values)).separatedBy(',').showDefault();
}

double realtimeRate_Hz(const BenchOptions& options) {
  constexpr double kUsual_Hz = 1000, kHighest_Hz = 1e5;
  return options.rate_Hz > kHighest_Hz ? kUsual_Hz : options.rate_Hz;
}

std::vector<SubjectMaker> subjectsOf(const BenchOptions& options) {
  std::vector<SubjectMaker> subjects;
  const auto add = [&](const std::function<Subject(Context&)>& make) {
    subjects.emplace_back([&options, make](Context& context) {
      Subject subject = make(context);
      warmUp(context, options);
      return subject;
    });
  };
  const EstimateOn where = options.wants("vulkan") ? EstimateOn::gpu : EstimateOn::cpu;
  for (const std::string& file : options.models)
    add([file, where](Context& context) { return loadSubject(context, file, where); });
  std::vector<std::int64_t> sizes = options.sizes;
  if (subjects.empty() && sizes.empty()) sizes.push_back(1'000'000);
  for (const std::int64_t size : sizes)
    add([size](Context& context) { return makeSubject(context, static_cast<std::size_t>(size)); });
  return subjects;
}

Session startSession(Context& context, const Model& model, const BenchBackend& options, const BenchSession& more) {
  checkBackend(context, options);
  SessionConfig config = configOn(model, options);
  config.brush = more.brush;
  config.rate_Hz = more.rate_Hz;
  const std::shared_ptr<const Model> shared(std::shared_ptr<void>(), &model);
  return Session(config, shared,
                 {.backend = context.backends().named(config.backend.name),
                  .threads = context.threads(),
                  .keepsPoints = more.keepsPoints,
                  .undo = {.bytes = more.undo_bytes},
                  .engine = {.sort = *valueNamed(kSortMethods, options.sort),
                             .spareSlots = options.spareSlots,
                             .wait = valueNamed(kWaits, options.wait)}});
}

void checkBackend(const Context& context, const BenchBackend& options) {
  checkBackendOptions(context, options);
  if (!options.wait.empty() && options.backend != "vulkan")
    throw UsageError("--wait: only --backend vulkan supports it");
}

SurfaceOptions surfaceOptions(Context& context, const Model& model, const BackendOptions& options) {
  SessionConfig config;
  setBackend(config, options);
  return context.backends().named(options.backend).surface(model, config.surface);
}

HashGrid gridFor(Context& context, const Model& model, const BenchBackend& options) {
  return gridFor(model, configOn(model, options).index, surfaceOptions(context, model, options).radius);
}

std::vector<std::string> methodChoices(const Context& context, const std::string& backend) {
  const auto& best = context.backends().named(backend).methods();
  return {best.rbegin(), best.rend()};
}

void checkMethods(const Context& context, const BenchOptions& options) {
  for (const std::string& method : options.methods) {
    std::vector<std::string> all;
    for (const std::string& backend : options.backends)
      std::ranges::copy(methodChoices(context, backend), std::back_inserter(all));
    if (std::ranges::find(all, method) == all.end())
      throw UsageError("--method: {} is not one of {}", method, fmt::join(all, ", "));
  }
}

Json summaryOf(const Summary& s) {
  if (s.count == 0) return nullptr;
  return {{"n", s.count}, {"min", s.min}, {"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
}

Json describeRun(Context& context, const BenchOptions& options) {
  Json machines = Json::object();
  for (const std::string& backend : options.backends) {
    const std::string machine = context.backends().named(backend).machine(context.threads());
    fmt::print(context.tables(), "{}: {}\n", backend, machine);
    machines[backend] = machine;
  }
  const Json run{{"command", context.commandLine()},
                 {"date", fmt::format("{:%F}", fmt::gmtime(std::time(nullptr)))},
                 {"version", PALPATE_VERSION}};
  return {{"run", run}, {"machines", machines}};
}

void listRun(std::vector<ResultFacts>& all, const std::string& bench) {
  constexpr DescribedKey keys[]{{"run", "", "command line, day (UTC) and version of this program"},
                                {"machines", "", "machine of each back end"}};
  listResults(all, bench, "", keys);
}

Json measureAlone(Context& context, const BenchOptions& options, const std::string& name,
                  const std::function<Json()>& measure, PlotScript script) {
  checkMethods(context, options);
  checkOutput(options.plotFile, Output::plot);
  Json result = describeRun(context, options);
  warmUp(context, options);
  result[name] = measure();
  context.writeJson(result);
  if (!options.plotFile.empty()) plot(script, result, options.plotFile);
  return result[name];
}

void listBenchResults(std::vector<ResultFacts>& all) {
  listTimeResults(all);
  using List = void (*)(std::vector<ResultFacts>&);
  for (const auto& [bench, list] :
       std::initializer_list<std::pair<const char*, List>>{{"bench touch", &listTouchBenchResults},
                                                           {"bench edit", &listEditBenchResults},
                                                           {"bench mesh", &listMeshBenchResults},
                                                           {"bench splat", &listSplatBenchResults},
                                                           {"bench coexist", &listCoexistBenchResults},
                                                           {"bench stream", &listStreamBenchResults},
                                                           {"bench strokes", &listStrokesBenchResults},
                                                           {"bench matter", &listMatterBenchResults},
                                                           {"bench read", &listReadBenchResults},
                                                           {"bench select", &listSelectBenchResults},
                                                           {"bench share", &listShareBenchResults}}) {
    listRun(all, bench);
    list(all);
  }
}

void addBench(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("bench", "measure on this machine; each bench has its own options");
  sub.requireSubcommands(1, 0);
  addTimeBenches(sub, context, command);
  std::vector<const Options*> together;
  for (const auto& bench : sub.subcommands()) {
    bench->under("Times; several at once share one plot");
    together.push_back(bench.get());
  }
  addTouchBench(sub, context, command);
  addEditBench(sub, context, command);
  addMeshBench(sub, context, command);
  addSplatBench(sub, context, command);
  addCoexistBench(sub, context, command);
  addStreamBench(sub, context, command);
  addStrokesBench(sub, context, command);
  addMatterBench(sub, context, command);
  addReadBench(sub, context, command);
  addSelectBench(sub, context, command);
  addShareBench(sub, context, command);
  for (const auto& bench : sub.subcommands())
    if (!std::ranges::count(together, bench.get())) bench->under("Each alone, with its own tables");
  sub.footer("palpate bench NAME --help shows the options of that bench.\n");
  sub.whenNamed([&command, &sub, together] {
    command = [named = sub.named(), together, run = command] {
      for (const Options* bench : named)
        if (named.size() > 1 && !std::ranges::count(together, bench))
          throw UsageError("bench {} must run alone; it has its own tables and plot", bench->name());
      run();
    };
  });
}

}  // namespace palpate
