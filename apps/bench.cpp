#include "apps/bench.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"

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

bool BenchOptions::wants(std::string_view name) const { return std::ranges::find(backends, name) != backends.end(); }

void addSubjectOptions(CLI::App& bench, BenchOptions& options) {
  bench.add_option("--models,--model", options.models, "PLY files")->type_name("FILE...");
  bench.add_option("--sizes", options.sizes, "numbers of points; a sculpture is made for each")
      ->check(wholeBetween(1, 2e9))
      ->type_name("N...");
}

CLI::Option* addBackendsOption(CLI::App& bench, BenchOptions& options, std::vector<std::string> choices) {
  return bench.add_option("--backend", options.backends, "what answers; several are measured one after another")
      ->check(CLI::IsMember(std::move(choices)))
      ->delimiter(',')
      ->capture_default_str();
}

void addMethodsOption(CLI::App& bench, BenchOptions& options, const std::string& what) {
  bench.add_option("--method", options.methods, what)->delimiter(',');
}

void addRepeatOptions(CLI::App& bench, BenchOptions& options) {
  bench.add_option("--repeat", options.repeat, "repetitions of each measurement")
      ->check(wholeBetween(1, bounds::kMostCount))
      ->capture_default_str();
  bench.add_option("--limit", options.limit_s, "s that one measurement may take, 5 repetitions at least; 0: no limit")
      ->check(between(0, bounds::kLongest_s))
      ->capture_default_str();
}

void addRateOption(CLI::App& bench, BenchOptions& options) {
  bench.add_option("--rate", options.rate_Hz, "ticks per second at most")
      ->check(between(1e-3, 1e9))
      ->capture_default_str();
}

void addFrictionOption(CLI::App& bench, BenchOptions& options) {
  bench.add_option("--friction", options.backend.friction, "coefficient of a proxy that slides")
      ->check(between(0, bounds::kMostFriction))
      ->capture_default_str();
}

void addPlotOption(CLI::App& bench, BenchOptions& options, const std::string& what) {
  bench.add_option("--plot", options.plotFile, what + " (needs matplotlib)")->type_name("IMG.png");
}

CLI::Option* addListOption(CLI::App& bench, const std::string& name, std::vector<std::string>& values,
                           const std::string& what) {
  return bench.add_option(name, values, what)->check(CLI::IsMember(values))->delimiter(',')->capture_default_str();
}

double realtimeRate_Hz(const BenchOptions& options) {
  constexpr double kUsual_Hz = 1000, kHighest_Hz = 1e5;
  return options.rate_Hz > kHighest_Hz ? kUsual_Hz : options.rate_Hz;
}

std::vector<SubjectMaker> subjectsOf(const BenchOptions& options) {
  std::vector<SubjectMaker> subjects;
  const EstimateOn where = options.wants("vulkan") ? EstimateOn::gpu : EstimateOn::cpu;
  for (const std::string& file : options.models)
    subjects.emplace_back([file, where](Context& context) { return loadSubject(context, file, where); });
  std::vector<std::int64_t> sizes = options.sizes;
  if (subjects.empty() && sizes.empty()) sizes.push_back(1'000'000);
  for (const std::int64_t size : sizes)
    subjects.emplace_back([size](Context& context) { return makeSubject(context, static_cast<std::size_t>(size)); });
  return subjects;
}

void checkMethods(const BenchOptions& options) {
  for (const std::string& method : options.methods) {
    std::vector<std::string> all;
    for (const std::string& backend : options.backends)
      std::ranges::copy(methodChoices(backend), std::back_inserter(all));
    if (std::ranges::find(all, method) == all.end())
      throw UsageError("--method: {} is none of {}", method, fmt::join(all, ", "));
  }
}

Json measureAlone(Context& context, const BenchOptions& options, const std::string& name,
                  const std::function<Json()>& measure, PlotScript script) {
  checkMethods(options);
  Context::checkWritable(options.plotFile);
  Json result{{"machines", Json::object()}};
  for (const std::string& backend : options.backends) result["machines"][backend] = machineOf(context, backend);
  for (const auto& [backend, machine] : result["machines"].items())
    fmt::print(context.tables(), "{}: {}\n", backend, machine.get<std::string>());
  result[name] = measure();
  context.writeJson(result);
  if (!options.plotFile.empty()) plot(script, result, options.plotFile);
  return result[name];
}

void addBench(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand("bench", "measure on this machine; each bench has options of its own");
  sub->require_subcommand(1, 0);
  addTimeBenches(*sub, context, command);
  const std::vector<CLI::App*> together = sub->get_subcommands({});
  for (CLI::App* bench : together) bench->group("Times; ask for several at once to have them in one plot");
  addTouchBench(*sub, context, command);
  addEditBench(*sub, context, command);
  addMeshBench(*sub, context, command);
  addSplatBench(*sub, context, command);
  addCoexistBench(*sub, context, command);
  addLocalityBench(*sub, context, command);
  for (CLI::App* bench : sub->get_subcommands({}))
    if (!std::ranges::count(together, bench)) bench->group("Alone, with tables of their own");
  sub->footer("palpate bench NAME --help shows the options of that bench.\n");
  sub->callback([&command, sub, together] {
    command = [named = sub->get_subcommands(), together, run = command] {
      for (const CLI::App* bench : named)
        if (named.size() > 1 && !std::ranges::count(together, bench))
          throw UsageError("bench {}: ask for it alone; its tables and its plot are its own", bench->get_name());
      run();
    };
  });
}

}  // namespace palpate
