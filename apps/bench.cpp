#include "apps/bench.hpp"
#include "apps/picture.hpp"
#include "apps/plot.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/mesh/mesh_plan.hpp"
#include "shaders/shared/render.h"

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

void checkMethods(const BenchOptions& options) {
  for (const std::string& method : options.methods) {
    std::vector<std::string> all;
    for (const std::string& backend : options.backends)
      std::ranges::copy(methodChoices(backend), std::back_inserter(all));
    if (std::ranges::find(all, method) == all.end())
      throw UsageError("--method: {} is none of {}", method, fmt::join(all, ", "));
  }
}

bool asksFor(const BenchOptions& options, std::string_view name) {
  return std::ranges::find(options.names, name) != options.names.end();
}

// The one of the benches that are asked for alone; empty where there is none. Their pages have nothing in common with
// the plot of times.
std::string aloneOf(const BenchOptions& options) {
  for (const char* name : {"touch", "edit", "mesh", "splat", "coexist", "locality"})
    if (asksFor(options, name)) return name;
  return "";
}

void benchAlone(Context& context, const BenchOptions& options, const std::string& name) {
  if (options.names.size() > 1)
    throw UsageError("bench {}: ask for it alone; its tables and its plot are its own", name);
  if (name != "touch" && name != "edit" && !options.plotFile.empty())
    throw UsageError("bench {}: there is no --plot of it", name);
  if (name == "mesh" && options.backends != std::vector<std::string>{"vulkan"})
    throw UsageError("bench mesh: only --backend vulkan meshes");
  checkMethods(options);
  Context::checkWritable(options.plotFile);
  Json result{{"machines", Json::object()}};
  for (const std::string& backend : options.backends) result["machines"][backend] = machineOf(context, backend);
  for (const auto& [backend, machine] : result["machines"].items())
    fmt::print(context.tables(), "{}: {}\n", backend, machine.get<std::string>());
  if (name == "touch") result[name] = benchTouch(context, options);
  if (name == "edit") result[name] = benchEdit(context, subjectsOf(options), options);
  if (name == "mesh") result[name] = benchMesh(context, subjectsOf(options), options);
  if (name == "splat") result[name] = benchSplat(context, subjectsOf(options), options);
  if (name == "coexist") result[name] = benchCoexist(context, subjectsOf(options), options);
  if (name == "locality") result[name] = benchLocality(context, options);
  context.writeJson(result);
  if (name == "locality" && result[name]["broken"] > 0)
    throw Error("bench locality: {} of {} strokes changed what an edit may not; the table says what",
                result[name]["broken"].get<std::size_t>(), result[name]["strokes"].size());
  if (!options.plotFile.empty()) plot(name == "touch" ? PlotScript::touch : PlotScript::edit, result, options.plotFile);
}

// What is usual there, where the user says nothing.
void setCoexistDefaults(const CLI::App& sub, BenchOptions& options) {
  const auto given = [&](const char* option) { return sub.get_option(option)->count() > 0; };
  if (!given("--size")) options.size = "1920x1080";
  if (!given("--samples")) options.samples = 1;
  if (!given("--sizes") && !given("--models")) options.sizes = {1'000'000, 5'000'000, 20'000'000};
  if (!given("--touched")) return;
  if (options.edit.touched.size() != 1) throw UsageError("bench coexist: one number of points for --touched");
  options.coexist.touched = options.edit.touched.front();
}

void bench(Context& context, const BenchOptions& options) {
  checkMethods(options);
  for (const std::string& surface : options.surfaces)
    for (const std::string& backend : options.backends) checkBackendOptions({.backend = backend, .surface = surface});
  Context::checkWritable(options.plotFile);
  std::vector<BenchRecord> records;
  for (const auto& makeOne : subjectsOf(options)) {
    const Subject subject = makeOne(context);
    for (const std::string& name : options.names) {
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
  for (const std::string& name : options.names) printTables(out, name, records);
  context.writeJson(result);
  if (!options.plotFile.empty()) plot(PlotScript::bench, result, options.plotFile);
}

}  // namespace

double realtimeRate_Hz(const BenchOptions& options) {
  constexpr double kUsual_Hz = 1000, kHighest_Hz = 1e5;
  return options.rate_Hz > kHighest_Hz ? kUsual_Hz : options.rate_Hz;
}

bool BenchOptions::wants(std::string_view name) const { return std::ranges::find(backends, name) != backends.end(); }

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

void addBench(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand(
      "bench",
      "measure on this machine: build (the index), sort (its largest part, alone), query (a probe at rest), step (a "
      "haptic tick), edit (a tick that sculpts), mesh (marching cubes), splat (a picture, and how true it is), coexist "
      "(touch beside pictures that are drawn as fast as they go); touch "
      "judges what is felt against surfaces "
      "that are known; locality judges what an edit changes that it may not");
  auto options = std::make_shared<BenchOptions>();
  options->backend.surface = "average";  // which every back end has
  sub->add_option("names", options->names, "build, sort, query, step; or touch; or edit; or mesh; or splat; or coexist; or locality")
      ->required()
      ->check(CLI::IsMember({"build", "sort", "query", "step", "touch", "edit", "mesh", "splat", "coexist", "locality"}))
      ->type_name("NAME...");
  sub->add_option("--models,--model", options->models, "PLY files")->type_name("FILE...");
  sub->add_option("--sizes", options->sizes, "numbers of points; a sculpture is made for each")
      ->check(between(1, 2e9))
      ->type_name("N...");
  CLI::Option* backends = sub->add_option("--backend", options->backends,
                                          "what answers; several are measured one after another (touch: cpu where "
                                          "there is no GPU but a software driver)")
                              ->check(CLI::IsMember(backendChoices()))
                              ->delimiter(',')
                              ->capture_default_str();
  sub->add_option("--method", options->methods, "query methods of query and step (default: all) and edit (fused)")
      ->delimiter(',');
  sub->add_option("--tool-points", options->toolPoints,
                  "step: at rest with tools of so many points, too, by the method fused and the CPU")
      ->check(between(1, static_cast<double>(kMostToolPoints)))
      ->delimiter(',')
      ->type_name("N,...");
  sub->add_option("--tool", options->tool, "step: which tool")
      ->check(CLI::IsMember({"pad", "ball", "spatula"}))
      ->capture_default_str();
  sub->add_option("--tool-size", options->toolSize_mm, "step: as in touch, mm")
      ->check(positive())
      ->capture_default_str();
  sub->add_option("--repeat", options->repeat, "repetitions of each measurement")
      ->check(between(1, 1e9))
      ->capture_default_str();
  sub->add_option("--limit", options->limit_s, "s that one measurement may take, 5 repetitions at least; 0: no limit")
      ->check(notNegative())
      ->capture_default_str();
  sub->add_option("--rate", options->rate_Hz, "ticks per second of query, step and edit at most")
      ->check(positive())
      ->capture_default_str();
  sub->add_option("--moved", options->movedShare, "share of the points that build moves to another cell first")
      ->check(between(0, 1))
      ->capture_default_str();
  sub->add_option("--size", options->size,
                  "splat, coexist: of the pictures, width x height, pixels (coexist: 1920x1080)")
      ->capture_default_str();
  addSamplesOption(*sub, options->samples);
  sub->add_option("--smooth", options->smooths_px,
                  "splat: pixels to each side over which depth is smoothed; several are judged")
      ->check(CLI::Range(0u, shared::kMostSmooth_px / 2))
      ->delimiter(',')
      ->capture_default_str();
  sub->add_option("--raster", options->rasters, "splat: who draws the discs, as in render; several are compared")
      ->delimiter(',')
      ->capture_default_str();
  sub->add_option("--mesh", options->meshes,
                  "splat: draws marching cubes, too, with so many cells along the longest side, from the same clouds "
                  "and cameras; one table of all ways")
      ->check(between(1, kFinestLattice))
      ->delimiter(',')
      ->type_name("N,...");
  sub->add_option("--plot", options->plotFile, "draw times against points, a line for each way (needs matplotlib)")
      ->type_name("IMG.png");
  addIndexOptions(*sub, options->backend);
  addTouchBenchOptions(*sub, options->touch);
  addEditBenchOptions(*sub, options->edit);
  addMeshBenchOptions(*sub, options->mesh);
  addCoexistBenchOptions(*sub, options->coexist);
  addLocalityBenchOptions(*sub, options->locality);
  sub->add_option("--friction", options->backend.friction, "touch, step, query: coefficient of a proxy that slides")
      ->check(notNegative())
      ->capture_default_str();
  sub->footer(
      "build: in the order of the file, then in the order of the last build with some points moved (--moved).\n"
      "query: the HIP rests half a support radius above the surface; one gather, one surface.\n"
      "step: the HIP rests in contact; static, then edited: the surface yields so slowly that every tick edits.\n"
      "edit: a tool slides over the surface at 50 mm/s and sculpts at every tick. Tables of us on the GPU and from "
      "pose "
      "to force (in virtual time with the whole edit), points that were touched, full builds of the index, MiB of "
      "index "
      "and lists, and all memory of points, index and lists over that of the same cloud without edits; from which "
      "share "
      "of the points on a full build is cheaper.\n"
      "mesh: ms on the GPU for each pass of marching cubes and for a mesh that follows an edit, memory, and the "
      "distance "
      "of vertices and the error of normals against shapes that are known.\n"
      "splat: ms of each pass, of a whole picture and pictures per second; then pictures of --shapes under clean and "
      "uneven --conditions against rays cast in double precision: pixels without surface, overlap of the silhouettes, "
      "error of depth and of normals. --quick leaves that out.\n"
      "coexist: a tool slides over the surface in real time, alone and beside a thread that draws one picture after "
      "another, and sculpts or not. 1, 5 and 20 million points, pictures of 1920x1080 with one sample a pixel, a tool "
      "that reaches 1000 points and 10 s each, unless --sizes, --models, --size, --samples, --touched and --duration "
      "say otherwise. Tables of us from pose to force, missed ticks, pictures per second and ms that a picture takes.\n"
      "touch: slides 1 mm deep at 5, 50 and 200 mm/s, presses, taps, pushes through plates; M1 angle between force and "
      "true normal, M2 height of the proxy, M3 force against true depth, M4 dF/dt and its share in 50 to 500 Hz, "
      "in all and off edges, M5 pushes that came through, M6 lag behind a god-object on the truth, M7 tick times, M8 "
      "force in the air, M10 "
      "tangential force (there is no friction: mu is 0) and drift at rest, M11 after an edit, M12 the same path "
      "twice, and the CPU against the back end.\n"
      "locality: each brush, a press that is held and a slide, with a tool of 3 mm 3 mm deep, on vulkan and cpu; then "
      "the hand is lifted until nothing changes. Points that moved or went beyond the tool's radius from its way, new "
      "ones beyond that and a support radius, or nearer than 0.4 spacings of their place to another, or, carving, "
      "outside the old surface; normals that look to the other side; changes by a brush without effect, before and "
      "after. Exit code 1 when an edit changed what it may not.\n");
  sub->callback([&, options, backends, sub] {
    if (sub->get_option("--surface")->count() > 0) options->surfaces = options->touch.surfaces;
    command = [&context, sub, options, chosen = backends->count() > 0] {
      const std::string alone = aloneOf(*options);
      if (alone.empty()) return bench(context, *options);
      if (alone == "locality" && !chosen) options->backends = {"vulkan", "cpu"};
      if (alone == "touch" && !chosen) options->backends = {ownTouchBackend(context)};
      if (alone == "coexist") setCoexistDefaults(*sub, *options);
      benchAlone(context, *options, alone);
    };
  });
}

}  // namespace palpate
