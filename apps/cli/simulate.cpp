#include <algorithm>
#include <cmath>

#include "apps/cli/context.hpp"
#include "apps/cli/progress.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/statistics.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/matter_scene_file.hpp"
#include "engine/io/saving.hpp"
#include "engine/matter/matter_world.hpp"
#include "engine/matter/soft_scan.hpp"
#include "engine/matter/soft_world.hpp"

namespace palpate {

namespace {

constexpr double kLongestDuration_s = 1e5;
constexpr double kMmPerMetre = 1e3;

struct SimulateOptions {
  std::string scene, model, probe, save;
  double duration_s = 1;
};

MatterScene sceneOf(const SimulateOptions& options) {
  const auto names = matterSceneNames();
  MatterScene scene = std::ranges::find(names, options.scene) != names.end() ? matterSceneNamed(options.scene)
                                                                             : readMatterScene(options.scene);
  if (options.model.empty()) return scene;
  if (scene.matter != Matter::soft) throw UsageError("--model: the scene is of {}", nameOf(kMatters, scene.matter));
  scene.model = options.model;
  return scene;
}

SoftWorld softWorldOf(Context& context, const MatterScene& scene) {
  const MatterOptions options{.threads = context.threads()};
  if (scene.model.empty()) return SoftWorld(scene, options);
  planOf(scene);  // before the file is read
  PointCloud cloud = readCloud(scene.model, &context.log(), {.pointsOnly = true}).cloud;
  const std::vector<SurfacePlace> points = placeScan(std::move(cloud), scene, context.threads());
  WorkerTeam team(context.threads());
  const Stopwatch watch;
  SoftSolid solid = scanSolid(points, scene.spacing_mm * 1e-3, scene.hole_mm * 1e-3, team);
  context.log().say("{}: {} points are filled with {} nodes: {:.0f} ms", scene.model, points.size(),
                    solid.lattice.nodes(), watch.elapsed_us() * 1e-3);
  return SoftWorld(scene, options, std::move(solid), points);
}

Json vectorJson(const DVec3& v) { return {v.x, v.y, v.z}; }

Json summaryJson(const Summary& summary) {
  return {{"p50", summary.p50}, {"p99", summary.p99}, {"p999", summary.p999}, {"max", summary.max}};
}

// What has failed, and what to do.
template <class World>
void requireRunning(const World& world) {
  if (world.state() == MatterState::running) return;
  throw Error("the simulation {} after {:.3f} s; take more substeps",
              world.state() == MatterState::diverged ? "has diverged" : "has too many particles in one place",
              world.time_s());
}

PointCloud cloudOf(const MatterWorld& world) { return {.positions = world.positionsById()}; }

PointCloud cloudOf(SoftWorld& world) {
  CloudFrame frame;
  world.makeFrame(frame);
  return {.positions = std::move(frame.positions), .normals = std::move(frame.normals)};
}

// `cloud`: in m.
void save(const std::string& file, PointCloud cloud) {
  for (Vec3& position : cloud.positions) position *= static_cast<float>(kMmPerMetre);
  cloud.storedAs.comments.emplace_back("comment units: mm");
  markAsOurs(cloud);
  writeCloud(file, cloud);
}

double pressureAt(const MatterWorld& world, const DVec3& place_m) { return world.pressureAt(place_m); }
double pressureAt(const SoftWorld&, const DVec3&) { return 0; }

template <class World>
void simulate(Context& context, const SimulateOptions& options, const MatterScene& scene, World& world) {
  const DVec3 probe_mm = options.probe.empty() ? DVec3(0) : parseVec3(options.probe, "--probe");
  const auto steps = static_cast<std::size_t>(std::llround(options.duration_s / kMatterStep_s));
  std::vector<double> step_us;
  double mostCompression = 0;
  Progress progress(context.log(), options.scene);
  for (std::size_t k = 0; k < steps; ++k) {
    const Stopwatch watch;
    world.step();
    step_us.push_back(watch.elapsed_us());
    requireRunning(world);
    mostCompression = std::max(mostCompression, world.observe().maxCompression);
    progress.set(static_cast<double>(k + 1) / static_cast<double>(steps));
  }
  if (!options.save.empty()) save(options.save, cloudOf(world));
  const MatterObservation seen = world.observe();
  const Summary times = summarize(std::move(step_us));
  const bool hasPressure = !options.probe.empty() && scene.matter == Matter::water;
  const double pressure_Pa = hasPressure ? pressureAt(world, probe_mm / kMmPerMetre) : 0;
  std::FILE* out = context.tables();
  fmt::print(out, "{}: {} {} of {}, {:.3f} s in {} substeps a millisecond\n", options.scene, seen.particles,
             scene.matter == Matter::soft ? "nodes" : "particles", nameOf(kMatters, scene.matter), seen.time_s,
             world.plan().substeps);
  fmt::print(out, "  a millisecond takes {:.0f} us (median), {:.0f} us at most\n", times.p50, times.max);
  fmt::print(out, "  kinetic {:.3g} J, potential {:.6g} J, compressed by {:.2f} % at most, front at {:.1f} mm\n",
             seen.kinetic_J, seen.potential_J, 100 * mostCompression, seen.front_m * kMmPerMetre);
  if (hasPressure) fmt::print(out, "  pressure at {} mm: {:.1f} Pa\n", options.probe, pressure_Pa);
  context.writeJson({{"time_s", seen.time_s},
                     {"particles", seen.particles},
                     {"substeps", world.plan().substeps},
                     {"step_us", summaryJson(times)},
                     {"kinetic_J", seen.kinetic_J},
                     {"potential_J", seen.potential_J},
                     {"momentum_kg_m_s", vectorJson(seen.momentum)},
                     {"max_compression", mostCompression},
                     {"front_mm", seen.front_m * kMmPerMetre},
                     {"pressure_Pa", hasPressure ? Json(pressure_Pa) : Json(nullptr)}});
}

void simulate(Context& context, const SimulateOptions& options) {
  if (!options.save.empty()) Context::checkWritable(options.save);
  if (!options.probe.empty()) parseVec3(options.probe, "--probe");  // refused before anything runs
  const MatterScene scene = sceneOf(options);
  if (scene.matter == Matter::soft) {
    SoftWorld world = softWorldOf(context, scene);
    simulate(context, options, scene, world);
  } else {
    MatterWorld world(scene, {.threads = context.threads()});
    simulate(context, options, scene, world);
  }
}

}  // namespace

void addSimulate(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("simulate", "matter that moves by itself, without a hand, on the CPU");
  auto options = std::make_shared<SimulateOptions>();
  std::string names;
  for (const std::string_view name : matterSceneNames()) names += (names.empty() ? "" : ", ") + std::string(name);
  sub.add("scene", options->scene, "a JSON file, or one of " + names).required().typeName("SCENE");
  sub.add("--model", options->model, "a closed cloud that is the surface of a soft scene, in place of the scene's own")
      .typeName("FILE");
  sub.add("--duration", options->duration_s, "simulated time, s").check(between(0, kLongestDuration_s)).showDefault();
  sub.add("--probe", options->probe, "x,y,z where the pressure of water is asked for at the end, mm");
  sub.add("--save", options->save,
          "file for the particles, or the surface of a soft body, at the end, mm: " + cloudFormats().endingsWritten())
      .typeName("FILE");
  sub.whenNamed([&, options] { command = [&context, options] { simulate(context, *options); }; });
}

}  // namespace palpate
