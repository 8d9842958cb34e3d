#include "apps/bench_times.hpp"

#include <algorithm>
#include <set>

namespace palpate {

namespace {

Json toJson(const BenchRecord& record) {
  const auto summary = [](const Summary& s) -> Json {
    if (s.count == 0) return nullptr;
    return {{"n", s.count}, {"min", s.min}, {"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
  };
  return {{"bench", record.bench},
          {"backend", record.backend},
          {"way", record.way},
          {"input", record.input},
          {"subject", record.subject},
          {"points", record.points},
          {"gpu_us", summary(record.gpu_us)},
          {"wall_us", summary(record.wall_us)}};
}

// One table in the layout of the thesis (Tables 4.1 and 5.4): models down, by size, and ways across; medians and 99.9th
// percentiles in us of `time`. Ways that were not measured have no column.
void printTable(std::FILE* out, const std::string& title, const std::vector<BenchRecord>& records,
                Summary BenchRecord::*time) {
  using Row = std::pair<std::size_t, std::string>;  // points, subject
  std::vector<Row> rows;
  std::vector<std::string> ways;
  for (const BenchRecord& record : records) {
    if ((record.*time).count == 0) continue;
    if (const Row row{record.points, record.subject}; std::ranges::find(rows, row) == rows.end()) rows.push_back(row);
    if (std::ranges::find(ways, record.way) == ways.end()) ways.push_back(record.way);
  }
  std::ranges::sort(rows);
  const auto cell = [&](const Row& row, const std::string& way) -> std::string {
    for (const BenchRecord& record : records)
      if (const Summary& s = record.*time;
          record.way == way && Row{record.points, record.subject} == row && s.count > 0)
        return s.p999 < 1e5 ? fmt::format("{:.1f} / {:.1f}", s.p50, s.p999)
                            : fmt::format("{:.0f} / {:.0f}", s.p50, s.p999);
    return "–";
  };
  fmt::print(out, "\n{}\n{:<24}{:>12}", title, "model", "points");
  for (const std::string& way : ways) fmt::print(out, "{:>22}", way);
  fmt::print(out, "\n");
  for (const Row& row : rows) {
    fmt::print(out, "{:<24}{:>12}", row.second, row.first);
    for (const std::string& way : ways) fmt::print(out, "{:>22}", cell(row, way));
    fmt::print(out, "\n");
  }
}

void printTables(std::FILE* out, const std::string& bench, const std::vector<BenchRecord>& all) {
  // A table for each back end and input, in the order in which they were measured.
  std::vector<std::pair<std::string, std::string>> kinds;
  for (const BenchRecord& record : all)
    if (const std::pair kind{record.backend, record.input};
        record.bench == bench && std::ranges::find(kinds, kind) == kinds.end())
      kinds.push_back(kind);
  for (const auto& [backend, input] : kinds) {
    std::vector<BenchRecord> records;
    std::ranges::copy_if(all, std::back_inserter(records), [&](const BenchRecord& record) {
      return record.bench == bench && record.backend == backend && record.input == input;
    });
    for (const auto& [time, clock] : {std::pair{&BenchRecord::gpu_us, "on the GPU"}, {&BenchRecord::wall_us, "in all"}})
      if (std::ranges::any_of(records, [&](const BenchRecord& record) { return (record.*time).count > 0; }))
        printTable(out, fmt::format("{}, {}, {}, {}", bench, backend, input, clock), records, time);
  }
}

void measure(Context& context, const std::vector<std::string>& names, const TimeBenchOptions& options) {
  checkMethods(options);
  for (const std::string& surface : options.surfaces)
    for (const std::string& backend : options.backends) checkBackendOptions({.backend = backend, .surface = surface});
  Context::checkWritable(options.plotFile);
  std::vector<BenchRecord> records;
  for (const auto& makeOne : subjectsOf(options)) {
    const Subject subject = makeOne(context);
    for (const std::string& name : names) {
      context.log().say("{}: {}, {} points", name, subject.name, subject.model.cloud.size());
      if (name == "build") benchBuild(context, subject, options, records);
      if (name == "sort") benchSort(context, subject, options, records);
      if (name == "query") benchQuery(context, subject, options, records);
      if (name == "step") benchStep(context, subject, options, records);
    }
  }
  Json result{{"machines", Json::object()}, {"records", Json::array()}};
  for (const std::string& backend : options.backends) result["machines"][backend] = machineOf(context, backend);
  for (const BenchRecord& record : records) result["records"].push_back(toJson(record));
  std::FILE* out = context.tables();
  for (const auto& [backend, machine] : result["machines"].items())
    fmt::print(out, "{}: {}\n", backend, machine.get<std::string>());
  fmt::print(out, "us, median / p99.9\n");
  for (const std::string& name : names) printTables(out, name, records);
  context.writeJson(result);
  if (!options.plotFile.empty()) plot(PlotScript::bench, result, options.plotFile);
}

// Options of all these benches, into the same variables whichever of them is asked for: where several are, the last one
// reads them all.
void addOptions(CLI::App& bench, TimeBenchOptions& options) {
  addSubjectOptions(bench, options);
  addBackendsOption(bench, options, backendChoices());
  addMethodsOption(bench, options, "query methods (default: all)");
  bench.add_option("--surface", options.surfaces, "surfaces that are measured")
      ->check(CLI::IsMember(surfaceChoices()))
      ->delimiter(',')
      ->capture_default_str();
  addFrictionOption(bench, options);
  bench
      .add_option("--tool-points", options.toolPoints,
                  "at rest with tools of so many points, too, by the method fused and the CPU")
      ->check(wholeBetween(1, static_cast<double>(kMostToolPoints)))
      ->delimiter(',')
      ->type_name("N,...");
  bench.add_option("--tool", options.tool, "which tool")
      ->check(CLI::IsMember({"pad", "ball", "spatula"}))
      ->capture_default_str();
  bench.add_option("--tool-size", options.toolSize_mm, "as in touch, mm")
      ->check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      ->capture_default_str();
  addRepeatOptions(bench, options);
  addRateOption(bench, options);
  bench.add_option("--moved", options.movedShare, "share of the points that move to another cell first")
      ->check(between(0, 1))
      ->capture_default_str();
  addRadiusOption(bench, options.backend);
  addIndexOptions(bench, options.backend);
  addPlotOption(bench, options, "draw times against points, a line for each way");
}

struct TimeBench {
  const char *name, *what, *footer;
  std::set<std::string_view> options;  // that mean something to it
};

const std::set<std::string_view> kOfAll{"--models", "--sizes", "--backend", "--repeat", "--limit", "--plot"};
const std::set<std::string_view> kOfGrid{"--bucket-key", "--radius", "--cell", "--grid"};
const std::set<std::string_view> kOfQuery{"--method", "--surface", "--friction", "--rate",
                                          "--sort",   "--ahead",   "--wait",     "--deterministic"};

const std::array<TimeBench, 4>& timeBenches() {
  static const std::array<TimeBench, 4> benches = [] {
    const auto all = [](std::initializer_list<std::set<std::string_view>> parts) {
      std::set<std::string_view> names = kOfAll;
      for (const auto& part : parts) names.insert(part.begin(), part.end());
      return names;
    };
    return std::array<TimeBench, 4>{
        {{"build", "the index",
          "In the order of the file, then in the order of the last build with some points moved (--moved).\n",
          all({kOfGrid, {"--moved"}})},
         {"sort", "the largest part of building the index, alone", "", all({})},
         {"query", "a probe at rest",
          "The HIP rests half a support radius above the surface; one gather, one surface.\n",
          all({kOfGrid, kOfQuery})},
         {"step", "a haptic tick",
          "The HIP rests in contact; static, then edited: the surface yields so slowly that every tick edits.\n",
          all({kOfGrid, kOfQuery, {"--tool", "--tool-points", "--tool-size"}})}}};
  }();
  return benches;
}

const TimeBench& timeBenchNamed(const std::string& name) {
  return *std::ranges::find(timeBenches(), name, [](const TimeBench& bench) { return std::string(bench.name); });
}

// Also of an option that --help hides, for which CLI11 has no name.
std::string nameOf(const CLI::Option& option) { return "--" + option.get_lnames().front(); }

// Each option that was given means something to one of the benches that are asked for.
void checkMeaning(const std::vector<CLI::App*>& asked) {
  for (const CLI::App* given : asked)
    for (const CLI::Option* option : given->get_options())
      if (option->count() > 0 && std::ranges::none_of(asked, [&](const CLI::App* bench) {
            return timeBenchNamed(bench->get_name()).options.contains(nameOf(*option));
          }))
        throw UsageError("bench {}: there is no {} of it", given->get_name(), nameOf(*option));
}

}  // namespace

void addTimeBenches(CLI::App& bench, Context& context, Command& command) {
  const auto options = std::make_shared<TimeBenchOptions>();
  options->backend.surface = "average";  // which every back end has
  for (const TimeBench& each : timeBenches()) {
    CLI::App* sub = bench.add_subcommand(each.name, each.what);
    addOptions(*sub, *options);
    for (CLI::Option* option : sub->get_options({}))
      if (!each.options.contains(nameOf(*option))) option->group("");
    sub->get_help_ptr()->group("Options");
    sub->footer(each.footer);
    sub->callback([&, options] {
      command = [&context, &bench, options] {
        const std::vector<CLI::App*> asked = bench.get_subcommands();
        checkMeaning(asked);
        std::vector<std::string> names;
        for (const CLI::App* one : asked) names.push_back(one->get_name());
        measure(context, names, *options);
      };
    });
  }
}

}  // namespace palpate
