#include <algorithm>
#include <map>

#include "apps/bench/bench.hpp"
#include "apps/bench/picture_judge.hpp"
#include "apps/cli/look.hpp"
#include "apps/cli/parse_list.hpp"
#include "apps/cli/picture.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/thinning.hpp"
#include "engine/gpu/workgroup_watch.hpp"
#include "engine/io/triangle_mesh_file.hpp"
#include "shaders/watched.hpp"

namespace palpate {

namespace {

struct SplatBenchOptions : WayOptions {
  std::string size = "1280x720";             // size of the pictures
  std::uint32_t samples = 4;                 // samples per pixel
  std::vector<std::uint32_t> smooths_px{0};  // FrameOptions::smooth_px
  std::vector<std::string> shapes, conditions;
  std::vector<std::string> lights;
  std::string truthFile;  // the mesh that the model was scanned from
  bool quick = false;
};

// Times of a frame, ms: on the GPU, per pass and in total, and from its submission until its completion.
struct FrameTimes {
  std::vector<std::pair<std::string, Summary>> passes;
  Summary gpu_ms, wall_ms;
};

struct SplatCost {
  std::string subject, raster, light;
  std::size_t points = 0;
  FrameTimes times;
  Summary made_ms;                          ///< GPU time to build a mesh
  std::uint64_t bytes = 0;                  ///< memory of the drawn data and the frame's images
  std::vector<WorkgroupWatch::Life> lives;  ///< longest life of the workgroups, by pass; empty if the GPU has no clock

  double fps() const { return times.wall_ms.p50 > 0 ? 1000 / times.wall_ms.p50 : 0; }
  /// If the points move, each picture requires a new mesh.
  double fpsRemeshed() const { return fps() > 0 ? 1000 / (times.wall_ms.p50 + made_ms.p50) : 0; }
};

struct SplatQuality {
  std::string shape, condition, raster;
  std::uint32_t smooth_px = 0;
  std::size_t points = 0;
  double spacing = 0;
  PictureJudgement picture;
  std::optional<SplatCost> cost;  ///< cost of the same picture, shaded, where meshes are compared
};

struct SplatCondition {
  std::string_view name;
  double thinning;  ///< density at one end over that at the other
};
constexpr std::array<SplatCondition, 2> kSplatConditions{{{"clean", 1}, {"uneven", 10}}};
constexpr std::array<std::string_view, 4> kShapes{"sphere", "torus", "bumpy-sphere", "cube"};

constexpr std::array<std::string_view, 2> kLights{"plain", "full"};

// As the window draws: with all light that a GPU draws by default, or with none of it.
FrameOptions pictureOptions(const Model& model, std::string_view light) {
  const bool full = light == "full";
  return {.light = {.occlusion = full, .cavity = full, .ground = full}, .up = directionOf(model.upright.up)};
}

FrameTimes measureFrames(Device& device, Frame& frame, const PictureWay& way, const Camera& camera,
                         const FrameOptions& picture, const SplatBenchOptions& options) {
  FrameTimes times;
  CommandList list(device, device.throughputQueue(), "frame", CommandList::Timing::passes);
  // The first picture also creates pipelines and the map of the shadow on the ground, which later ones use.
  for (int time = 0; time < 2; ++time) {
    list.begin();
    way.record(frame, list, camera, picture);
    list.end();
    device.throughputQueue().run(list);
  }
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> passes;
  std::vector<double> gpu, wall;
  repeatMeasurement(options, [&](std::int64_t) {
    const Stopwatch watch;
    device.throughputQueue().run(list);
    wall.push_back(1e-3 * watch.elapsed_us());
    double sum = 0;
    std::map<std::string, double> each;  // passes over small and large splats share a name
    for (const PassRecord& pass : list.passes()) {
      if (std::ranges::find(names, pass.name) == names.end()) names.push_back(pass.name);
      each[pass.name] += 1e-3 * pass.gpu_us;
      sum += 1e-3 * pass.gpu_us;
    }
    for (const auto& [name, ms] : each) passes[name].push_back(ms);
    gpu.push_back(sum);
  });
  for (const std::string& name : names) times.passes.emplace_back(name, summarize(passes[name]));
  times.gpu_ms = summarize(gpu);
  times.wall_ms = summarize(wall);
  return times;
}

// Longest life of the workgroups of a picture, which is how long touch may have to wait.
std::vector<WorkgroupWatch::Life> livesOf(Device& device, const DrawnCloud& drawn, const Camera& camera,
                                          const UVec2& size, std::uint32_t supersample) {
  if (!WorkgroupWatch::isPossible(device)) return {};
  constexpr int kPictures = 20;
  const WorkgroupWatch watch(device, shader_code::watched);
  Frame frame(device, size.x, size.y, supersample);
  CommandList list(device, device.throughputQueue(), "watched frame");
  list.begin();
  frame.record(list, drawn, camera, {});
  list.end();
  for (int picture = 0; picture < kPictures; ++picture) device.throughputQueue().run(list);
  return watch.longest();
}

SplatCost costOf(Context& context, const std::string& subject, const Model& model, const PictureWay& way,
                 std::string_view light, const Camera& camera, const UVec2& size, const SplatBenchOptions& options) {
  Device& device = context.device();
  const std::uint64_t before = device.allocatedBytes();
  const std::uint32_t supersample = options.samples > 1 ? 2 : 1;
  Frame frame(device, size.x, size.y, supersample);
  SplatCost cost{.subject = subject,
                 .raster = way.name,
                 .light = std::string(light),
                 .points = model.cloud.size(),
                 .made_ms = way.made_ms};
  cost.times = measureFrames(device, frame, way, camera, pictureOptions(model, light), options);
  cost.bytes = way.bytes + device.allocatedBytes() - before;
  if (way.name == "compute") cost.lives = livesOf(device, *way.discs, camera, size, supersample);
  return cost;
}

PictureJudgement judge(Device& device, const PictureTruth& truth, const PictureWay& way, double spacing,
                       std::uint32_t smooth_px) {
  Frame frame(device, truth.width, truth.height, 1);
  CommandList list(device, device.throughputQueue(), "judged frame");
  list.begin();
  way.record(frame, list, truth.camera, {.pass = ImagePass::normal, .smooth_px = smooth_px});
  list.end();
  device.throughputQueue().run(list);
  return judgePicture(truth, frame.readDepth(), frame.readColor(), spacing);
}

// Draws one cloud with each method and compares it with the truth. Where discs and meshes are compared, also times the
// same pictures.
void judgeWays(Context& context, const std::string& shape, const std::string& condition, const Model& model,
               const PictureTruth& truth, const SplatBenchOptions& options, std::vector<SplatQuality>& results) {
  forEachWay(context, model, options, [&](const PictureWay& way) {
    std::optional<SplatCost> cost;
    if (!options.meshes.empty())
      cost = costOf(context, shape, model, way, kLights[0], truth.camera, {truth.width, truth.height}, options);
    for (const std::uint32_t smooth_px : options.smooths_px)
      results.push_back({.shape = shape,
                         .condition = condition,
                         .raster = way.name,
                         .smooth_px = smooth_px,
                         .points = model.cloud.size(),
                         .spacing = model.spacing,
                         .picture = judge(context.device(), truth, way, model.spacing, smooth_px),
                         .cost = cost});
  });
}

void judgeShapes(Context& context, const UVec2& size, const SplatBenchOptions& options,
                 std::vector<SplatQuality>& results) {
  const auto points = static_cast<std::size_t>(options.sizes.empty() ? 200'000 : options.sizes.front());
  for (const std::string_view name : kShapes) {
    if (std::ranges::find(options.shapes, name) == options.shapes.end()) continue;
    const auto shape = makeShape(name);
    std::optional<PictureTruth> truth;
    for (const SplatCondition& condition : kSplatConditions) {
      if (std::ranges::find(options.conditions, condition.name) == options.conditions.end()) continue;
      context.log().say("splat: {}, {}, {} points, against truth", name, condition.name, points);
      const auto drawn = static_cast<double>(points) / shareThatStays(condition.thinning);
      PointCloud cloud =
          sampleShape(*shape, {.count = static_cast<std::size_t>(std::round(drawn)), .threads = context.threads()});
      if (condition.thinning > 1) cloud = thinnedAlong(cloud, condition.thinning);
      // Without a closed formula a ray takes a hundred times as long.
      const std::uint32_t stride = name == "bumpy-sphere" ? 4 : 1;
      if (!truth) truth = pictureTruth(traced(*shape), cloud, size.x, size.y, stride, context.threads());
      Model model{.cloud = std::move(cloud), .scale = {1}};
      model.spacing = meanSpacing(model.cloud, context.threads());
      warmUp(context, options);
      judgeWays(context, std::string(name), std::string(condition.name), model, *truth, options, results);
    }
  }
}

// Compares a scan with the mesh that it was taken from.
void judgeScan(Context& context, const Subject& subject, const UVec2& size, const SplatBenchOptions& options,
               std::vector<SplatQuality>& results) {
  context.log().say("splat: {} against {}", subject.name, options.truthFile);
  constexpr std::uint32_t kStride = 3;  // closest-point queries on a mesh are slow
  const TriangleMesh mesh = readTriangleMesh(options.truthFile);
  const PointCloud& cloud = subject.model.cloud;
  Bounds bounds = boundsOf(cloud);
  bounds.min += cloud.origin;
  bounds.max += cloud.origin;
  const PictureTruth truth = pictureTruth(traced(mesh, bounds), cloud, size.x, size.y, kStride, context.threads());
  judgeWays(context, subject.name, "scan", subject.model, truth, options, results);
}

// Without extremes.
Json middleQuantilesOf(const Summary& s) { return {{"n", s.count}, {"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}}; }

using Value = std::optional<Json>;

constexpr Reported<SplatCost> kSplatCosts[]{
    {"subject", "", "model", field<&SplatCost::subject>},
    {"raster", "", "rasteriser, or the mesh", field<&SplatCost::raster>},
    {"light", "", "plain, or full: with occlusion, cavity and the shadow on the ground", field<&SplatCost::light>},
    {"points", "", "points of the model", field<&SplatCost::points>},
    {"passes_ms", "ms", "time on the GPU, by pass",
     [](const SplatCost& c) -> Value {
       Json passes = Json::object();
       for (const auto& [name, time] : c.times.passes) passes[name] = middleQuantilesOf(time);
       return passes;
     }},
    {"gpu_ms", "ms", "of all passes", [](const SplatCost& r) -> Value { return middleQuantilesOf(r.times.gpu_ms); }},
    {"picture_ms", "ms", "time of a picture from its submission to its completion",
     [](const SplatCost& r) -> Value { return middleQuantilesOf(r.times.wall_ms); }},
    {"fps", "1/s", "pictures per second", field<&SplatCost::fps>},
    {"made_ms", "ms", "time on the GPU to build the mesh",
     [](const SplatCost& r) -> Value { return middleQuantilesOf(r.made_ms); }},
    {"fps_with_remesh", "1/s", "pictures per second, each with a new mesh", field<&SplatCost::fpsRemeshed>},
    {"longest_workgroup_us", "us", "longest lifetime of a workgroup, by pass",
     [](const SplatCost& c) -> Value {
       Json lives = Json::object();
       for (const auto& life : c.lives) lives[life.pass] = life.longest_us;
       return lives;
     }},
    {"bytes", "B", "memory of the drawn data and of the picture's images", field<&SplatCost::bytes>},
};

constexpr Reported<SplatQuality> kSplatQualities[]{
    {"shape", "", "shape, or the scan", field<&SplatQuality::shape>},
    {"condition", "", "clean, uneven or scan", field<&SplatQuality::condition>},
    {"raster", "", "rasteriser, or the mesh", field<&SplatQuality::raster>},
    {"smooth_px", "px", "radius over which depth is smoothed", field<&SplatQuality::smooth_px>},
    {"points", "", "points of the cloud", field<&SplatQuality::points>},
    {"spacing", "model units", "mean distance of neighbouring points", field<&SplatQuality::spacing>},
    {"pixels", "", "compared pixels on the surface", [](const SplatQuality& r) -> Value { return r.picture.pixels; }},
    {"hole_pixels", "", "of these, pixels without surface, or with one more than three spacings behind",
     [](const SplatQuality& r) -> Value { return r.picture.holes; }},
    {"overlap_percent", "%", "intersection of the two silhouettes over their union",
     [](const SplatQuality& r) -> Value { return r.picture.overlap; }},
    {"depth_rms_spacings", "spacings", "root mean square of the error of depth",
     [](const SplatQuality& r) -> Value { return r.picture.depthRms; }},
    {"normal_deg.mean", "deg", "mean angle to the true normal",
     [](const SplatQuality& r) -> Value { return r.picture.normalMean_deg; }},
    {"normal_deg.p95", "deg", "its 95th percentile",
     [](const SplatQuality& r) -> Value { return r.picture.normalP95_deg; }},
    {"cost", "", "cost of the same picture, as in costs, if meshes are compared (--mesh)",
     [](const SplatQuality& r) -> Value { return partBy(kSplatCosts, r.cost); }},
};

struct SplatResults {
  UVec2 size;
  std::uint32_t samples = 1;
  std::vector<SplatCost> costs;
  std::vector<SplatQuality> qualities;
};

constexpr Reported<SplatResults> kSplatBench[]{
    {"size", "px", "width and height of a picture",
     [](const SplatResults& r) -> Value {
       return Json{r.size.x, r.size.y};
     }},
    {"samples", "", "samples of a pixel", field<&SplatResults::samples>},
    {"costs", "", "one for each model and rasteriser",
     [](const SplatResults& r) -> Value { return arrayBy(kSplatCosts, r.costs); }},
    {"qualities", "", "one for each picture compared with the truth",
     [](const SplatResults& r) -> Value { return arrayBy(kSplatQualities, r.qualities); }},
};

Json benchSplat(Context& context, const SplatBenchOptions& options) {
  const auto [width, height] = parseList<std::uint32_t, 2>(options.size, 'x', "--size", "WIDTHxHEIGHT in pixels");
  Frame::checkSize(width, height);
  for (const std::string& raster : options.rasters) rasterNamed(raster);
  const UVec2 size(width, height);
  const bool scan = !options.truthFile.empty();
  if (scan && options.models.size() != 1)
    throw UsageError("bench splat: --truth requires exactly one model; --models has {}", options.models.size());
  std::vector<SplatCost> costs;
  std::vector<SplatQuality> qualities;
  for (const SubjectMaker& makeOne : subjectsOf(options)) {
    const Subject subject = makeOne(context);
    context.log().say("splat: {}, {} points", subject.name, subject.model.cloud.size());
    const Camera camera = Camera::fitting(subject.model.cloud, static_cast<double>(size.x) / size.y, 45,
                                          framingOf(subject.model, subject.model.upright.up));
    forEachWay(context, subject.model, options, [&](const PictureWay& way) {
      for (const std::string& light : options.lights)
        costs.push_back(costOf(context, subject.name, subject.model, way, light, camera, size, options));
    });
    if (scan) judgeScan(context, subject, size, options, qualities);
  }
  std::ranges::stable_sort(costs, {}, &SplatCost::points);
  if (!options.quick && !scan) judgeShapes(context, size, options, qualities);
  Json json = jsonBy(kSplatBench, SplatResults{size, options.samples, std::move(costs), std::move(qualities)});
  printTables(context.tables(), "splat", json);
  return json;
}

void addOptions(Options& bench, SplatBenchOptions& options) {
  addSubjectOptions(bench, options);
  bench.add("--size", options.size, "size of the pictures, WIDTHxHEIGHT in pixels").showDefault();
  addSamplesOption(bench, options.samples);
  bench.add("--raster", options.rasters, "rasteriser of the discs, as in render; several are compared")
      .separatedBy(',')
      .showDefault();
  bench
      .add("--mesh", options.meshes,
           "also draw marching cubes with this number of cells along the longest side, from the same clouds and "
           "cameras; one table compares all")
      .check(wholeBetween(1, kMaxResolution))
      .separatedBy(',')
      .typeName("N,...");
  bench.add("--smooth", options.smooths_px, "radius over which depth is smoothed, pixels; several are judged")
      .check(inRange(0u, shared::kMaxSmooth_px / 2))
      .separatedBy(',')
      .showDefault();
  for (const std::string_view shape : kShapes) options.shapes.emplace_back(shape);
  for (const SplatCondition& condition : kSplatConditions) options.conditions.emplace_back(condition.name);
  addListOption(bench, "--shapes", options.shapes, "shapes to draw");
  addListOption(bench, "--conditions", options.conditions, "clean: exact clouds; uneven: ten times sparser at one end");
  options.lights.assign(kLights.begin(), kLights.end());
  addListOption(bench, "--light", options.lights,
                "plain, or full: with occlusion, cavity and the shadow on the ground, as a GPU draws by default");
  bench.add("--truth", options.truthFile, "the mesh that the model was scanned from, in the same coordinates")
      .typeName("MESH.ply");
  bench.addFlag("--quick", options.quick, "only measure times");
  addRepeatOptions(bench, options);
  addBackendsOption(bench, options, {"vulkan"});
}

}  // namespace

void listSplatBenchResults(std::vector<ResultFacts>& all) {
  listAlone(all, "splat", ".", kSplatBench);
  listAlone(all, "splat", ".costs[].", kSplatCosts);
  listAlone(all, "splat", ".qualities[].", kSplatQualities);
}

void addSplatBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("splat", "cost and accuracy of a picture");
  const auto options = std::make_shared<SplatBenchOptions>();
  addOptions(sub, *options);
  sub.footer(
      "ms of each pass and of a whole picture, and pictures per second; then pictures of --shapes under --conditions "
      "against rays cast in double precision: pixels without surface, overlap of the silhouettes, error of depth and "
      "of normals. --quick skips the comparison.\n");
  sub.whenNamed([&, options] { command = measuringAlone(context, options, "splat", benchSplat); });
}

}  // namespace palpate
