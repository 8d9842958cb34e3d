// Cost of a mesh, per pass, and its accuracy.
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <map>

#include "apps/bench/bench.hpp"
#include "apps/cli/mesh_options.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

struct MeshBenchOptions : BenchOptions {
  std::vector<std::int64_t> resolutions{64, 128, 256};
  std::vector<std::string> surfaces{"sphere"}, shapes;
  std::int64_t truthPoints = 200'000;
};

using Samples = std::map<std::string, std::vector<double>>;

// The passes in order, with their times.
std::vector<std::pair<std::string, double>> named(const MeshTimes& times) {
  return {{"index", times.index},         {"list", times.list},     {"field", times.field},
          {"classify", times.classify},   {"scan", times.scan},     {"vertices", times.vertices},
          {"triangles", times.triangles}, {"in all", times.total()}};
}

// An edit for timing: points around one of them are pushed in by a tenth of the support radius, and back.
constexpr double kEdit_radii = 2;
constexpr float kDent_radii = 0.1f;

std::vector<PointState> dentAt(const PointCloud& cloud, const MeshPlan& plan, bool back) {
  std::vector<PointState> edits;
  const Vec3 middle = cloud.positions[cloud.size() / 3];
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (glm::distance(cloud.positions[i], middle) > static_cast<float>(kEdit_radii) * plan.lattice.radius) continue;
    const Vec3 by = back ? Vec3(0) : kDent_radii * plan.lattice.radius * cloud.normals[i];
    edits.push_back({.position = cloud.positions[i] - by,
                     .id = i,
                     .normal = cloud.normals[i],
                     .color = cloud.hasColors() ? std::bit_cast<std::uint32_t>(cloud.colors[i]) : 0});
  }
  return edits;
}

std::string inMs(const Json& summary) {
  return fmt::format("{:.2f} / {:.2f}", summary["p50"].get<double>() * 1e-3, summary["p999"].get<double>() * 1e-3);
}

Json measure(Context& context, const Subject& subject, std::int64_t resolution, const std::string& surface,
             const BenchOptions& options) {
  const PointCloud& cloud = subject.model.cloud;
  const MeshPlan plan = planFor(subject.model, {.resolution = resolution, .surface = surface});
  MarchingCubes cubes = makeCubes(context, subject.model, plan);
  cubes.build();
  const std::uint64_t bytes = cubes.bytes();
  Samples samples;
  MeshStep step;
  repeatMeasurement(options, [&](std::int64_t) {
    const Stopwatch watch;
    step = cubes.build();
    samples["wall"].push_back(watch.elapsed_us());
    for (const auto& [name, time] : named(step.gpu_us)) samples[name].push_back(time);
  });
  const std::uint32_t vertices = cubes.vertexCount(), triangles = cubes.triangleCount();
  Json passes = Json::object();
  for (const auto& [name, unused] : named(step.gpu_us)) passes[name] = summaryOf(summarize(samples[name]));

  const std::vector<PointState> there = dentAt(cloud, plan, false), back = dentAt(cloud, plan, true);
  MeshStep edited = cubes.update(there);
  repeatMeasurement(options, [&](std::int64_t i) {
    edited = cubes.update(i % 2 == 0 ? back : there);
    samples["edited"].push_back(edited.gpu_us.total());
  });
  return {{"subject", subject.name},
          {"points", cloud.size()},
          {"resolution", resolution},
          {"surface", surface},
          {"blocks", step.blocks},
          {"vertices", vertices},
          {"triangles", triangles},
          {"gpu_bytes", bytes},
          {"gpu_us", passes},
          {"wall_us", summaryOf(summarize(samples["wall"]))},
          {"edit",
           {{"points", there.size()},
            {"treated_blocks", edited.treated},
            {"gpu_us", summaryOf(summarize(samples["edited"]))}}}};
}

void printTimes(std::FILE* out, const Json& records, std::int64_t resolution, const std::string& surface) {
  fmt::print(out, "\nmesh, resolution {}, {}: ms on the GPU, median / p99.9\n", resolution, surface);
  fmt::print(out, "{:<24}{:>10}{:>9}{:>9}{:>11}", "model", "points", "MiB", "FPS", "triangles");
  const std::vector<std::string> passes{"in all",   "index", "list",     "field",
                                        "classify", "scan",  "vertices", "triangles"};
  for (const std::string& pass : passes) fmt::print(out, "{:>20}", pass);
  fmt::print(out, "{:>20}{:>16}\n", "after an edit", "blocks of all");
  for (const Json& record : records) {
    if (record["resolution"].get<std::int64_t>() != resolution || record["surface"] != surface) continue;
    const double all_us = record["gpu_us"]["in all"]["p50"].get<double>();
    fmt::print(out, "{:<24}{:>10}{:>9.1f}{:>9.1f}{:>11}", record["subject"].get<std::string>(),
               record["points"].get<std::size_t>(), record["gpu_bytes"].get<double>() / (1 << 20),
               all_us > 0 ? 1e6 / all_us : 0.0, record["triangles"].get<std::size_t>());
    for (const std::string& pass : passes) fmt::print(out, "{:>20}", inMs(record["gpu_us"][pass]));
    fmt::print(out, "{:>20}{:>16}\n", inMs(record["edit"]["gpu_us"]),
               fmt::format("{} of {}", record["edit"]["treated_blocks"].get<std::size_t>(),
                           record["blocks"].get<std::size_t>()));
  }
}

// Compares a mesh of a known shape with the shape. Shapes are 100 units long, which are mm.
Json judge(Context& context, const std::string& name, std::size_t points, std::int64_t resolution,
           const std::string& surface) {
  const auto shape = makeShape(name);
  Model model{.cloud = sampleShape(*shape, {.count = points, .threads = context.threads()}), .scale = {1}};
  model.spacing = meanSpacing(model.cloud, context.threads());
  MarchingCubes cubes = makeCubes(context, model, planFor(model, {.resolution = resolution, .surface = surface}));
  cubes.build();
  const Mesh mesh = cubes.download();
  std::vector<double> off(mesh.vertices.size()), angles(mesh.vertices.size());
  parallelFor(off.size(), context.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const DVec3 place = mesh.vertices.fileCoordinates(i);
      const SurfacePoint truth = shape->closest(place);
      off[i] = glm::distance(place, truth.position);
      // On an edge the shape has no normal; the normal towards a nearby vertex is meaningless.
      angles[i] = angleBetween_deg(DVec3(mesh.vertices.normals[i]), truth.normal);
    }
  });
  double squares = 0;
  for (const double distance : off) squares += distance * distance;
  const Summary distances = summarize(off), normals = summarize(angles);
  const double rms_mm = off.empty() ? 0 : std::sqrt(squares / static_cast<double>(off.size()));
  std::ranges::sort(angles);
  const MeshReport report = examine(mesh);
  return {{"shape", name},
          {"points", points},
          {"spacing_mm", model.spacing},
          {"resolution", resolution},
          {"surface", surface},
          {"vertices", report.vertices},
          {"closed", report.closed()},
          {"euler", report.euler()},
          {"flat_triangles", report.flat},
          {"distance_mm", {{"rms", rms_mm}, {"max", distances.max}}},
          {"distance_spacings", {{"rms", rms_mm / model.spacing}, {"max", distances.max / model.spacing}}},
          {"normal_deg", {{"mean", normals.mean}, {"p95", quantileOfSorted(angles, 0.95)}, {"max", normals.max}}}};
}

void printTruth(std::FILE* out, const Json& judgements) {
  fmt::print(out, "\nmesh against the shape: distance of the vertices, error of their normals\n");
  fmt::print(out, "{:<14}{:>9}{:>12}{:>10}{:>8}{:>7}{:>11}{:>11}{:>15}{:>15}{:>24}\n", "shape", "points", "resolution",
             "surface", "closed", "Euler", "RMS, mm", "max, mm", "RMS, spacings", "max, spacings",
             "mean / p95 / max, deg");
  for (const Json& j : judgements)
    fmt::print(out, "{:<14}{:>9}{:>12}{:>10}{:>8}{:>7}{:>11.5f}{:>11.5f}{:>15.5f}{:>15.5f}{:>24}\n",
               j["shape"].get<std::string>(), j["points"].get<std::size_t>(), j["resolution"].get<std::int64_t>(),
               j["surface"].get<std::string>(), j["closed"].get<bool>() ? "yes" : "no", j["euler"].get<std::int64_t>(),
               j["distance_mm"]["rms"].get<double>(), j["distance_mm"]["max"].get<double>(),
               j["distance_spacings"]["rms"].get<double>(), j["distance_spacings"]["max"].get<double>(),
               fmt::format("{:.3f} / {:.3f} / {:.2f}", j["normal_deg"]["mean"].get<double>(),
                           j["normal_deg"]["p95"].get<double>(), j["normal_deg"]["max"].get<double>()));
}

Json benchMesh(Context& context, const MeshBenchOptions& options) {
  std::FILE* out = context.tables();
  Json result{{"records", Json::array()}, {"truth", Json::array()}};
  for (const SubjectMaker& makeOne : subjectsOf(options)) {
    const Subject subject = makeOne(context);
    if (subject.model.cloud.empty()) throw Error("{} contains no points", subject.name);
    for (const std::int64_t resolution : options.resolutions)
      for (const std::string& surface : options.surfaces) {
        context.log().say("mesh: {}, {} points, resolution {}, {}", subject.name, subject.model.cloud.size(),
                          resolution, surface);
        result["records"].push_back(measure(context, subject, resolution, surface, options));
      }
  }
  for (const std::int64_t resolution : options.resolutions)
    for (const std::string& surface : options.surfaces) printTimes(out, result["records"], resolution, surface);
  if (options.truthPoints == 0) return result;
  for (const std::string& shape : options.shapes)
    for (const std::int64_t resolution : options.resolutions)
      for (const std::string& surface : options.surfaces) {
        context.log().say("mesh: {} against the shape, resolution {}, {}", shape, resolution, surface);
        result["truth"].push_back(
            judge(context, shape, static_cast<std::size_t>(options.truthPoints), resolution, surface));
      }
  printTruth(out, result["truth"]);
  return result;
}

void addOptions(Options& bench, MeshBenchOptions& options) {
  addSubjectOptions(bench, options);
  bench.add("--resolution", options.resolutions, "cells along the longest side")
      .check(wholeBetween(1, kMaxResolution))
      .typeName("N...")
      .showDefault();
  bench.add("--mesh-surface", options.surfaces, "surface to mesh")
      .check(oneOf(namesOf(kMeshSurfaces)))
      .separatedBy(',')
      .showDefault();
  for (const std::string_view name : shapeNames()) options.shapes.emplace_back(name);
  addListOption(bench, "--shapes", options.shapes, "shapes that the mesh is compared with");
  bench.add("--truth-points", options.truthPoints, "points of those shapes; 0: none")
      .check(wholeBetween(0, 1e8))
      .showDefault();
  addRepeatOptions(bench, options);
  addBackendsOption(bench, options, {"vulkan"});
}

}  // namespace

void listMeshBenchResults(std::vector<ResultFacts>& all) {
  constexpr DescribedKey keys[]{
      {".records", "", "one for each model, resolution and surface"},
      {".records[].subject", "", "model"},
      {".records[].points", "", "its points"},
      {".records[].resolution", "", "cells along the longest side"},
      {".records[].surface", "", "meshed surface"},
      {".records[].blocks", "", "blocks of cells at the surface"},
      {".records[].vertices", "", "vertices"},
      {".records[].triangles", "", "triangles"},
      {".records[].gpu_bytes", "B", "memory on the GPU"},
      {".records[].gpu_us", "us", "time on the GPU, by pass and in all"},
      {".records[].wall_us", "us", "time in all"},
      {".records[].edit.points", "", "points of an edit"},
      {".records[].edit.treated_blocks", "", "blocks that its update computed again"},
      {".records[].edit.gpu_us", "us", "time of the update on the GPU"},
      {".truth", "", "one for each shape, resolution and surface"},
      {".truth[].shape", "", "shape"},
      {".truth[].points", "", "points of its cloud"},
      {".truth[].spacing_mm", "mm", "mean distance of neighbouring points"},
      {".truth[].resolution", "", "cells along the longest side"},
      {".truth[].surface", "", "meshed surface"},
      {".truth[].vertices", "", "vertices"},
      {".truth[].closed", "", "true if the mesh has no border"},
      {".truth[].euler", "", "Euler's characteristic"},
      {".truth[].flat_triangles", "", "triangles without area"},
      {".truth[].distance_mm", "mm", "distance of the vertices from the shape: rms and max"},
      {".truth[].distance_spacings", "spacings", "the same in spacings"},
      {".truth[].normal_deg", "deg", "error of their normals: mean, p95 and max"},
  };
  listAlone(all, "mesh", "", keys);
}

void addMeshBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("mesh", "marching cubes");
  const auto options = std::make_shared<MeshBenchOptions>();
  addOptions(sub, *options);
  sub.footer(
      "ms on the GPU for each pass of marching cubes and for the update after an edit, memory, and the distance of "
      "vertices and the error of normals relative to known shapes.\n");
  sub.whenNamed([&, options] {
    command = [&context, options] {
      measureAlone(context, *options, "mesh", [&] { return benchMesh(context, *options); });
    };
  });
}

}  // namespace palpate
