// Cost of a mesh, per pass, and its accuracy.
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

// Cost of a mesh, and of its update after an edit.
struct MeshCost {
  std::string subject, surface;
  std::size_t points = 0;
  std::int64_t resolution = 0;
  std::uint32_t blocks = 0, vertices = 0, triangles = 0;
  std::uint64_t gpuBytes = 0;
  std::vector<std::pair<std::string, Summary>> passes_us;
  Summary wall_us;
  std::size_t editedPoints = 0;
  std::uint32_t treatedBlocks = 0;
  Summary edit_us;

  const Summary& pass_us(std::string_view pass) const {
    return std::ranges::find(passes_us, pass, &std::pair<std::string, Summary>::first)->second;
  }
};

// A mesh compared with the shape that its points lie on.
struct MeshQuality {
  std::string shape, surface;
  std::size_t points = 0;
  double spacing_mm = 0;
  std::int64_t resolution = 0;
  MeshReport mesh;
  double distanceRms_mm = 0, distanceMax_mm = 0;
  double normalMean_deg = 0, normalP95_deg = 0, normalMax_deg = 0;

  double inSpacings(double length_mm) const { return length_mm / spacing_mm; }
};

struct MeshResults {
  std::vector<MeshCost> costs;
  std::vector<MeshQuality> qualities;
};

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
                     .number = i,
                     .normal = cloud.normals[i],
                     .color = cloud.hasColors() ? std::bit_cast<std::uint32_t>(cloud.colors[i]) : 0});
  }
  return edits;
}

MeshCost measure(Context& context, const Subject& subject, std::int64_t resolution, const std::string& surface,
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
  std::vector<std::pair<std::string, Summary>> passes_us;
  for (const auto& [name, unused] : named(step.gpu_us)) passes_us.emplace_back(name, summarize(samples[name]));

  const std::vector<PointState> there = dentAt(cloud, plan, false), back = dentAt(cloud, plan, true);
  MeshStep edited = cubes.update(there);
  repeatMeasurement(options, [&](std::int64_t i) {
    edited = cubes.update(i % 2 == 0 ? back : there);
    samples["edited"].push_back(edited.gpu_us.total());
  });
  return {.subject = subject.name,
          .surface = surface,
          .points = cloud.size(),
          .resolution = resolution,
          .blocks = step.blocks,
          .vertices = vertices,
          .triangles = triangles,
          .gpuBytes = bytes,
          .passes_us = std::move(passes_us),
          .wall_us = summarize(samples["wall"]),
          .editedPoints = there.size(),
          .treatedBlocks = edited.treated,
          .edit_us = summarize(samples["edited"])};
}

// Compares a mesh of a known shape with the shape. Shapes are 100 units long, which are mm.
MeshQuality judge(Context& context, const std::string& name, std::size_t points, std::int64_t resolution,
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
  return {.shape = name,
          .surface = surface,
          .points = points,
          .spacing_mm = model.spacing,
          .resolution = resolution,
          .mesh = examine(mesh),
          .distanceRms_mm = rms_mm,
          .distanceMax_mm = distances.max,
          .normalMean_deg = normals.mean,
          .normalP95_deg = quantileOfSorted(angles, 0.95),
          .normalMax_deg = normals.max};
}

using Value = std::optional<Json>;

constexpr Reported<MeshCost> kMeshCosts[]{
    {"subject", "", "model", field<&MeshCost::subject>},
    {"points", "", "its points", field<&MeshCost::points>},
    {"resolution", "", "cells along the longest side", field<&MeshCost::resolution>},
    {"surface", "", "meshed surface", field<&MeshCost::surface>},
    {"blocks", "", "blocks of cells at the surface", field<&MeshCost::blocks>},
    {"vertices", "", "vertices", field<&MeshCost::vertices>},
    {"triangles", "", "triangles", field<&MeshCost::triangles>},
    {"gpu_bytes", "B", "memory on the GPU", field<&MeshCost::gpuBytes>},
    {"gpu_us", "us", "time on the GPU, by pass and in all",
     [](const MeshCost& c) -> Value {
       Json passes = Json::object();
       for (const auto& [name, us] : c.passes_us) passes[name] = summaryOf(us);
       return passes;
     }},
    {"wall_us", "us", "time in all", quantiles<&MeshCost::wall_us>},
    {"edit.points", "", "points of an edit", field<&MeshCost::editedPoints>},
    {"edit.treated_blocks", "", "blocks that its update computed again", field<&MeshCost::treatedBlocks>},
    {"edit.gpu_us", "us", "time of the update on the GPU", quantiles<&MeshCost::edit_us>},
};

constexpr Reported<MeshQuality> kMeshQualities[]{
    {"shape", "", "shape", field<&MeshQuality::shape>},
    {"points", "", "points of its cloud", field<&MeshQuality::points>},
    {"spacing_mm", "mm", "mean distance of neighbouring points", field<&MeshQuality::spacing_mm>},
    {"resolution", "", "cells along the longest side", field<&MeshQuality::resolution>},
    {"surface", "", "meshed surface", field<&MeshQuality::surface>},
    {"vertices", "", "vertices", [](const MeshQuality& q) -> Value { return q.mesh.vertices; }},
    {"closed", "", "true if the mesh has no border", [](const MeshQuality& q) -> Value { return q.mesh.closed(); }},
    {"euler", "", "Euler's characteristic", [](const MeshQuality& q) -> Value { return q.mesh.euler(); }},
    {"flat_triangles", "", "triangles without area", [](const MeshQuality& q) -> Value { return q.mesh.flat; }},
    {"distance_mm.rms", "mm", "distance of the vertices from the shape, root mean square",
     field<&MeshQuality::distanceRms_mm>},
    {"distance_mm.max", "mm", "its maximum", field<&MeshQuality::distanceMax_mm>},
    {"distance_spacings.rms", "spacings", "the same in spacings",
     [](const MeshQuality& q) -> Value { return q.inSpacings(q.distanceRms_mm); }},
    {"distance_spacings.max", "spacings", "its maximum",
     [](const MeshQuality& q) -> Value { return q.inSpacings(q.distanceMax_mm); }},
    {"normal_deg.mean", "deg", "mean error of their normals", field<&MeshQuality::normalMean_deg>},
    {"normal_deg.p95", "deg", "its 95th percentile", field<&MeshQuality::normalP95_deg>},
    {"normal_deg.max", "deg", "its maximum", field<&MeshQuality::normalMax_deg>},
};

constexpr Reported<MeshResults> kMeshBench[]{
    {"records", "", "one for each model, resolution and surface",
     [](const MeshResults& r) -> Value { return arrayBy(kMeshCosts, r.costs); }},
    {"truth", "", "one for each shape, resolution and surface",
     [](const MeshResults& r) -> Value { return arrayBy(kMeshQualities, r.qualities); }},
};

Json benchMesh(Context& context, const MeshBenchOptions& options) {
  MeshResults results;
  for (const SubjectMaker& makeOne : subjectsOf(options)) {
    const Subject subject = makeOne(context);
    if (subject.model.cloud.empty()) throw Error("{} contains no points", subject.name);
    for (const std::int64_t resolution : options.resolutions)
      for (const std::string& surface : options.surfaces) {
        context.log().say("mesh: {}, {} points, resolution {}, {}", subject.name, subject.model.cloud.size(),
                          resolution, surface);
        results.costs.push_back(measure(context, subject, resolution, surface, options));
      }
  }
  for (const std::string& shape : options.truthPoints > 0 ? options.shapes : std::vector<std::string>())
    for (const std::int64_t resolution : options.resolutions)
      for (const std::string& surface : options.surfaces) {
        context.log().say("mesh: {} against the shape, resolution {}, {}", shape, resolution, surface);
        results.qualities.push_back(
            judge(context, shape, static_cast<std::size_t>(options.truthPoints), resolution, surface));
      }
  Json json = jsonBy(kMeshBench, results);
  printTables(context.tables(), "mesh", json);
  return json;
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
  listAlone(all, "mesh", ".", kMeshBench);
  listAlone(all, "mesh", ".records[].", kMeshCosts);
  listAlone(all, "mesh", ".truth[].", kMeshQualities);
}

void addMeshBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("mesh", "marching cubes");
  const auto options = std::make_shared<MeshBenchOptions>();
  addOptions(sub, *options);
  sub.footer(
      "ms on the GPU for each pass of marching cubes and for the update after an edit, memory, and the distance of "
      "vertices and the error of normals relative to known shapes.\n");
  sub.whenNamed([&, options] { command = measuringAlone(context, options, "mesh", benchMesh); });
}

}  // namespace palpate
