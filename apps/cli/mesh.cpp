#include <fmt/ranges.h>

#include "apps/cli/mesh_options.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/progress.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/saving.hpp"
#include "engine/mesh/mesh_memory.hpp"

namespace palpate {

namespace {

struct MeshCommandOptions {
  ModelOptions model;
  MeshChoices choices;
  std::string output;
  bool ascii = false;
};

Json toJson(const MeshTimes& times) {
  return {{"index", times.index},         {"list", times.list},    {"field", times.field},
          {"classify", times.classify},   {"scan", times.scan},    {"vertices", times.vertices},
          {"triangles", times.triangles}, {"total", times.total()}};
}

std::string inWords(const MeshReport& report) {
  if (report.closed()) return fmt::format("closed, Euler number {}", report.euler());
  return fmt::format("open, {} border edges", report.borderEdges);
}

void mesh(Context& context, const MeshCommandOptions& options) {
  checkOutput(options.output, Output::mesh);
  const Model model = loadModel(context, options.model.config(), EstimateOn::gpu);
  if (model.cloud.empty()) throw FileError(options.model.file, "contains no points; there is nothing to mesh");
  Progress progress(context.log(), options.output);
  const MeshPlan plan = planFor(model, options.choices);
  const MeshMemory predicted = predictMeshMemory(model.cloud, plan);
  MarchingCubes cubes = makeCubes(context, model, plan);
  progress.set(0.2);
  const Stopwatch watch;
  const MeshStep step = cubes.build();
  const double wall_us = watch.elapsed_us();
  progress.set(0.7);
  requireTriangles(cubes, model, plan, options.model.file);
  Mesh result = cubes.download();
  progress.set(0.8);
  const double cell = static_cast<double>(plan.lattice.cell);
  const std::vector<std::string> lost = lostInMeshFile(options.output, result);
  if (!lost.empty()) context.log().say("{}: not kept: {}", options.output, fmt::join(lost, ", "));
  markAsOurs(result.vertices);
  std::filesystem::path kept;
  writeMesh(options.output, result, cell, options.ascii, whereToKeep(options.output, kept, context.log()));
  const MeshReport report = examine(result);
  context.log().say("{}: {}, {} in {}, {}; {}, {:.1f} MiB, {:.1f} ms", options.output,
                    counted(report.vertices, "vertex", "vertices"), counted(report.triangles, "triangle"),
                    counted(report.parts, "part"), inWords(report), counted(step.blocks, "block"),
                    static_cast<double>(cubes.bytes()) / (1 << 20), wall_us * 1e-3);
  // A radius of less than two spacings leaves holes between the points of a sparse part.
  const double bridging = static_cast<double>(shared::kSupportSpacings) * model.wideSpacing;
  if (!report.closed() && 0.5 * bridging > static_cast<double>(plan.lattice.radius))
    context.log().say("{}: its sparse parts have points {:.3g} mm apart; --radius {:.3g} closes the holes there",
                      options.output, model.scale.toMm(model.wideSpacing), model.scale.toMm(bridging));
  const double mm = model.scale.mm_per_unit;
  context.writeJson({{"file", options.output},
                     {"points", model.cloud.size()},
                     {"gpu", context.device().name()},
                     {"resolution", options.choices.resolution},
                     {"surface", options.choices.surface},
                     {"cell_mm", model.scale.toMm(cell)},
                     {"radius_mm", model.scale.toMm(static_cast<double>(plan.lattice.radius))},
                     {"vertices", report.vertices},
                     {"triangles", report.triangles},
                     {"edges", report.edges},
                     {"border_edges", report.borderEdges},
                     {"crowded_edges", report.crowdedEdges},
                     {"flat_triangles", report.flat},
                     {"parts", report.parts},
                     {"closed", report.closed()},
                     {"euler", report.euler()},
                     {"area_mm2", report.area * mm * mm},
                     {"volume_mm3", report.volume * mm * mm * mm},
                     {"blocks", step.blocks},
                     {"gpu_bytes", cubes.bytes()},
                     {"gpu_bytes_predicted", predicted.total()},
                     {"gpu_us", toJson(step.gpu_us)},
                     {"wall_us", wall_us}});
}

}  // namespace

void addMesh(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("mesh", "write a triangle mesh of a model (marching cubes on the GPU)");
  auto options = std::make_shared<MeshCommandOptions>();
  addModelOptions(sub, options->model);
  sub.add("-o,--output", options->output,
          "output, vertices with normals and triangles: " + cloudFormats().endingsWritten(Written::mesh))
      .required()
      .typeName("MESH.ply")
      .writes(Writes::replacing);
  addMeshOptions(sub, options->choices);
  sub.addFlag("--ascii", options->ascii, "write ASCII instead of binary little-endian");
  sub.footer(
      "The mesh is closed where the points leave no gap as wide as the support radius; the report "
      "gives the number of border edges and the Euler number: vertices - edges + triangles, 2 for "
      "each closed part minus 2 for each handle.\n");
  sub.whenNamed([&, options] { command = [&context, options] { mesh(context, *options); }; });
}

}  // namespace palpate
