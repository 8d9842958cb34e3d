#include <algorithm>
#include <filesystem>

#include "apps/bench/bench.hpp"
#include "apps/bench/touch_tables.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/thinning.hpp"
#include "engine/io/triangle_mesh_file.hpp"
#include "haptics/study/stability.hpp"
#include "haptics/touch_target.hpp"

namespace palpate {

namespace {

struct TouchBenchOptions : BenchOptions {
  std::vector<std::string> surfaces, shapes, conditions;
  std::string truthFile;  // the mesh that the models were scanned from
  bool quick = false;
};

struct Condition {
  std::string_view name;
  double noise = 0;        ///< deviation of the positions, spacings
  double thinning = 1;     ///< density at one end over that at the other
  double away = 0;         ///< distance of the centre from the origin, model units
  bool estimated = false;  ///< normals estimated from the points; otherwise true normals
};
constexpr std::array<Condition, 8> kConditions{{{"clean"},
                                                {"estimated", 0, 1, 0, true},
                                                {"noise-0.1", 0.1},
                                                {"noise-0.25", 0.25},
                                                {"noise-0.25-estimated", 0.25, 1, 0, true},
                                                {"noise-0.5", 0.5},
                                                {"uneven", 0, 10},
                                                {"far", 0, 1, 1e6}}};

// Starts of the slides in the unit square of a shape's area: on three faces of the cube, the last 8 mm before an edge
// that the slide crosses.
constexpr std::array<DVec2, 3> kStarts{{{0.41, 0.55}, {0.62, 0.23}, {0.32, 0.43}}};

JudgeSubject shapeSubject(const std::string& name, const Condition& condition, std::size_t count, unsigned threads) {
  const std::shared_ptr<const AnalyticShape> shape = makeShape(name, kDefaultLongestSide_mm, DVec3(condition.away));
  JudgeSubject subject{.name = name, .condition = std::string(condition.name), .owner = shape};
  subject.truth = truthOf(*shape);
  const auto drawn =
      static_cast<std::size_t>(std::round(static_cast<double>(count) / shareThatStays(condition.thinning)));
  const double spacing =
      condition.noise > 0 ? meanSpacing(sampleShape(*shape, {.count = count, .threads = threads}), threads) : 0;
  subject.noise = condition.noise * spacing;
  PointCloud cloud = sampleShape(*shape, {.count = drawn, .noise = subject.noise, .threads = threads});
  if (condition.thinning > 1) cloud = thinnedAlong(cloud, condition.thinning);
  if (condition.estimated) estimateNormals(cloud, 16, threads);
  const SpacingRange spacings = spacingRange(cloud, threads);
  subject.model.spacing = spacings.mean;
  subject.model.wideSpacing = spacings.wide;
  subject.model.noise = spacings.noise;
  subject.model.cloud = std::move(cloud);
  const AreaMap place = shape->areaMap(threads);
  for (const DVec2& start : kStarts) {
    const SurfacePoint on = place(start);
    subject.starts.push_back({on, frameAround(on.normal).v});
  }
  return subject;
}

JudgeSubject scanSubject(Context& context, const std::string& scan, const std::string& mesh) {
  auto truth = std::make_shared<const TriangleMesh>(readTriangleMesh(mesh));
  JudgeSubject subject{.name = std::filesystem::path(scan).stem().string(), .condition = "scan", .owner = truth};
  subject.truth = truthOf(*truth);
  subject.model = loadModel(context, {.file = scan}, EstimateOn::cpu);  // the result must not depend on a GPU
  constexpr std::size_t kSampled = 32'768;
  const PointCloud& cloud = subject.model.cloud;
  const TouchTarget target = chooseTarget(ThinnedCloud(cloud, kSampled), subject.model.shownBounds());
  const SurfacePoint on = truth->closest(cloud.origin + target.position);
  const Frame3 frame = frameAround(on.normal);
  for (const DVec3& towards : {frame.u, -0.5 * frame.u + 0.8 * frame.v, -0.5 * frame.u - 0.8 * frame.v})
    subject.starts.push_back({on, towards});
  return subject;
}

std::vector<std::function<JudgeSubject()>> judgedBy(Context& context, const TouchBenchOptions& options) {
  std::vector<std::function<JudgeSubject()>> subjects;
  for (const std::string& scan : options.models)
    subjects.emplace_back([&context, scan, mesh = options.truthFile] { return scanSubject(context, scan, mesh); });
  if (!subjects.empty()) return subjects;
  std::vector<std::int64_t> sizes = options.sizes;
  if (sizes.empty()) sizes.push_back(200'000);
  for (const std::int64_t size : sizes)
    for (const std::string& shape : options.shapes)
      for (const Condition& condition : kConditions)
        if (std::ranges::find(options.conditions, condition.name) != options.conditions.end())
          subjects.emplace_back([&context, shape, condition, size] {
            return shapeSubject(shape, condition, static_cast<std::size_t>(size), context.threads());
          });
  return subjects;
}

template <class Judge>
void forEachSurface(const TouchBenchOptions& options, Judge&& judgeOne) {
  for (const std::string& backend : options.backends)
    for (const std::string& surface : options.surfaces) {
      BenchBackend one = options.backend;
      one.backend = backend;
      one.surface = surface;
      one.method = options.methods.empty() ? "" : options.methods.front();
      judgeOne(one);
    }
}

std::vector<std::string> names(const auto& list) { return {list.begin(), list.end()}; }

// The loop closed through the simulated Touch; a late answer is the whole force of an old pose, the worst case.
std::vector<StabilityJudgement> judgeStability() {
  std::vector<StabilityJudgement> judgements;
  for (const bool controlled : {false, true})
    for (const double delay_ms : {0.0, 1.0, 3.0})
      for (const double damping : {0.0, 0.002, 0.008, 0.032}) {
        const StabilityOptions study{.damping_N_s_per_mm = damping,
                                     .passivity = controlled ? PassivityMode::on : PassivityMode::observe,
                                     .delay_ms = delay_ms};
        judgements.push_back({.delay_ms = delay_ms,
                              .damping_N_s_per_mm = damping,
                              .controlled = controlled,
                              .largest_N_per_mm = largestStableStiffness(study),
                              .leastEnergy_mJ = measureStability(study).leastEnergy_mJ});
      }
  return judgements;
}

Json benchTouch(Context& context, const TouchBenchOptions& options) {
  if (options.models.empty() != options.truthFile.empty())
    throw UsageError("bench touch: --models requires --truth and vice versa; without both, shapes are felt");
  JudgeOptions judgeOptions;
  if (options.quick) judgeOptions.speeds_mm_per_s = {50, 200};
  forEachSurface(options, [&](const BenchBackend& one) { checkBackend(context, one); });
  TouchResults results;
  const auto subjects = judgedBy(context, options);
  for (const auto& makeOne : subjects) {
    const JudgeSubject subject = makeOne();
    context.log().say("touch: {}, {}, {} points", subject.name, subject.condition, subject.model.cloud.size());
    const double widestRadius = surfaceOptions(context, subject.model, options.backend).radius;
    const JudgePlan plan = planFor(context, subject, widestRadius, judgeOptions);
    forEachSurface(options, [&](const BenchBackend& one) {
      results.judgements.push_back(judgeTouch(context, subject, plan, one, judgeOptions));
      if (!options.quick && (subject.condition == "clean" || subject.condition == "scan"))
        results.judgements.back().edit = judgeEdit(context, subject, one, judgeOptions);
    });
  }
  if (!options.quick && options.models.empty())
    forEachSurface(options, [&](const BenchBackend& one) {
      context.log().say("touch: thin plates, {}", one.surface);
      const std::int64_t points = options.sizes.empty() ? 200'000 : options.sizes.front();
      const auto plates = judgePlates(context, static_cast<std::size_t>(points), one);
      results.plates.insert(results.plates.end(), plates.begin(), plates.end());
    });
  if (!options.quick && options.models.empty()) results.stability = judgeStability();
  printTouchTables(context.tables(), results, judgeOptions.mainSpeed_mm_per_s);
  return toJson(results);
}

void addOptions(Options& bench, TouchBenchOptions& options) {
  options.surfaces = namesOf(kSurfaceKinds);
  options.shapes = names(shapeNames());
  for (const Condition& condition : kConditions) options.conditions.emplace_back(condition.name);
  addListOption(bench, "--shapes", options.shapes, "shapes to feel");
  addListOption(
      bench, "--conditions", options.conditions,
      "clean: exact clouds; noise-N: positions noisy by N spacings; estimated: normals from the points; uneven: ten "
      "times sparser at one end; far: 1e6 mm from the origin");
  bench.add("--sizes", options.sizes, "numbers of points on the shapes (default: 200000)")
      .check(wholeBetween(1, 2e9))
      .typeName("N...");
  bench.add("--models,--model", options.models, "scans to feel instead, with --truth").typeName("FILE...");
  bench.add("--truth", options.truthFile, "the mesh that the models were scanned from, in the same coordinates")
      .typeName("MESH.ply");
  bench.addFlag("--quick", options.quick, "no slides at 5 mm/s, no plates, no edits");
  addListOption(bench, "--surface", options.surfaces, "surfaces to judge");
  addFrictionOption(bench, options);
  addMethodsOption(bench, options, "how neighbours are found (default: the back end's choice)");
  addRadiusOption(bench, options.backend);
  addEngineOptions(bench, options.backend);
  addPlotOption(bench, options, "draw a page of the results");
}

}  // namespace

void addTouchBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("touch", "judge touch against known surfaces");
  const auto options = std::make_shared<TouchBenchOptions>();
  addOptions(sub, *options);
  Option backends = addBackendsOption(sub, *options, backendChoices());
  backends.describe(
      "back end; several are judged one after another (default: vulkan; cpu if the only GPU is a software driver)");
  sub.footer(
      "Slides 1 mm deep at 5, 50 and 200 mm/s, presses, taps, pushes through plates; M1 angle between force and true "
      "normal, M2 height of the proxy, M3 force against true depth, M4 dF/dt and its share in 50 to 500 Hz, in all and "
      "off edges, M5 pushes that came through, M6 lag behind a god-object on the truth, M7 tick times, M8 force in the "
      "air, M9 the largest stiffness that a hand holds steady, M10 tangential force (see --friction) "
      "and drift at rest, M11 after an edit, M12 the same "
      "path twice, and the CPU against the back end.\n");
  sub.whenNamed([&, options, backends] {
    command = [&context, options, chosen = backends.given()] {
      if (!chosen) options->backends = {chooseBackend(context, {.backend = "auto"}).name};
      measureAlone(
          context, *options, "touch", [&] { return benchTouch(context, *options); }, PlotScript::touch);
    };
  });
}

}  // namespace palpate
