#include "apps/bench/times.hpp"

#include <algorithm>
#include <set>

#include "apps/cli/output.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"

namespace palpate {

namespace {

constexpr Reported<BenchRecord> kTimeRecords[]{
    {"bench", "", "build, sort, query or step", field<&BenchRecord::bench>},
    {"backend", "", "back end", field<&BenchRecord::backend>},
    {"way", "", "method and what distinguishes it", field<&BenchRecord::way>},
    {"input", "", "order of the input", field<&BenchRecord::input>},
    {"subject", "", "model", field<&BenchRecord::subject>},
    {"points", "", "its points", field<&BenchRecord::points>},
    {"gpu_us", "us", "time on the GPU; null: not measured", quantiles<&BenchRecord::gpu_us>},
    {"wall_us", "us", "time in all; null: not measured", quantiles<&BenchRecord::wall_us>},
};

// One table in the layout of the thesis (Tables 4.1 and 5.4): a row per model, by size, and a column per method;
// medians and 99.9th percentiles of `time`, us. Methods that were not measured have no column.
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
  // A table for each back end and input, in the order of measurement.
  std::vector<std::pair<std::string, std::string>> kinds;
  for (const BenchRecord& record : all)
    if (const std::pair kind{record.backend, record.input};
        record.bench == bench && std::ranges::find(kinds, kind) == kinds.end())
      kinds.push_back(kind);
  for (const auto& [backend, input] : kinds) {
    std::vector<BenchRecord> records;
    std::ranges::copy_if(all, std::back_inserter(records), [&, &backend = backend, &input = input](const auto& record) {
      return record.bench == bench && record.backend == backend && record.input == input;
    });
    for (const auto& [time, clock] : {std::pair{&BenchRecord::gpu_us, "on the GPU"}, {&BenchRecord::wall_us, "in all"}})
      if (std::ranges::any_of(records, [time = time](const BenchRecord& each) { return (each.*time).count > 0; }))
        printTable(out, fmt::format("{}, {}, {}, {}", bench, backend, input, clock), records, time);
  }
}

void measure(Context& context, const std::vector<std::string>& names, const TimeBenchOptions& options) {
  checkMethods(context, options);
  for (const std::string& surface : options.surfaces)
    for (const std::string& backend : options.backends)
      checkBackendOptions(context, {.backend = backend, .surface = surface});
  checkOutput(options.plotFile, Output::plot);
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
  Json result = describeRun(context, options);
  result["records"] = arrayBy(kTimeRecords, records);
  std::FILE* out = context.tables();
  fmt::print(out, "us, median / p99.9\n");
  for (const std::string& name : names) printTables(out, name, records);
  context.writeJson(result);
  if (!options.plotFile.empty()) plot(PlotScript::bench, result, options.plotFile);
}

// Options of all these benches write to the same variables: if several benches are named, the last one reads them for
// all.
void addOptions(Options& bench, TimeBenchOptions& options) {
  addSubjectOptions(bench, options);
  addBackendsOption(bench, options, backendChoices());
  addMethodsOption(bench, options, "query methods (default: all)");
  bench.add("--surface", options.surfaces, "surfaces to measure")
      .check(oneOf(namesOf(kSurfaceKinds)))
      .separatedBy(',')
      .showDefault();
  addFrictionOption(bench, options);
  bench
      .add("--tool-points", options.toolPoints,
           "also measure tools with these numbers of points at rest (method fused, and the CPU)")
      .check(wholeBetween(1, static_cast<double>(kMaxToolPoints)))
      .separatedBy(',')
      .typeName("N,...");
  bench.add("--tool", options.tool, "shape of the tool").check(oneOf({"pad", "ball", "spatula"})).showDefault();
  bench.add("--tool-size", options.toolSize_mm, "size of the tool as in touch, mm")
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      .showDefault();
  addRepeatOptions(bench, options);
  addRateOption(bench, options);
  bench.add("--moved", options.movedShare, "fraction of the points that first move to another cell")
      .check(between(0, 1))
      .showDefault();
  addRadiusOption(bench, options.backend);
  addEngineOptions(bench, options.backend);
  addPlotOption(bench, options, "plot times against points, one line for each method");
}

struct TimeBench {
  const char *name, *what, *footer;
  std::set<std::string_view> options;  // the options that apply to it
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
         {"sort", "the largest part of an index build, alone", "", all({})},
         {"query", "a probe at rest",
          "The HIP rests half a support radius above the surface; one gather and one surface per query.\n",
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

// Each given option must apply to one of the named benches.
void checkMeaning(const std::vector<const Options*>& asked) {
  for (const Options* given : asked)
    for (const Option& option : given->all())
      if (option.given() && std::ranges::none_of(asked, [&](const Options* bench) {
            return timeBenchNamed(bench->name()).options.contains(option.longName());
          }))
        throw UsageError("bench {} has no option {}", given->name(), option.longName());
}

}  // namespace

Summary measureSection(Device& device, const CommandList& list, std::string_view section, const BenchOptions& options) {
  device.latencyQueue().run(list);
  std::vector<double> times;
  repeatMeasurement(options, [&](std::int64_t) {
    device.latencyQueue().run(list);
    times.push_back(list.sectionTime_us(section));
  });
  return summarize(times);
}

void listTimeResults(std::vector<ResultFacts>& all) {
  constexpr DescribedKey records[]{{"records", "", "one for each measurement"}};
  for (const TimeBench& each : timeBenches()) {
    const std::string bench = fmt::format("bench {}", each.name);
    listRun(all, bench);
    listResults(all, bench, "", records);
    listResults(all, bench, "records[].", kTimeRecords);
  }
}

void addTimeBenches(Options& bench, Context& context, Command& command) {
  const auto options = std::make_shared<TimeBenchOptions>();
  options->backend.surface = "average";  // available on every back end
  for (const TimeBench& each : timeBenches()) {
    Options& sub = bench.addSubcommand(each.name, each.what);
    addOptions(sub, *options);
    for (Option& option : sub.all())
      if (option.longName() != "--help" && !each.options.contains(option.longName())) option.under("");
    sub.footer(each.footer);
    sub.whenNamed([&, options] {
      command = [&context, &bench, options] {
        const std::vector<const Options*> asked = bench.named();
        checkMeaning(asked);
        std::vector<std::string> names;
        names.reserve(asked.size());
        for (const Options* one : asked) names.push_back(one->name());
        measure(context, names, *options);
      };
    });
  }
}

}  // namespace palpate
