#include <algorithm>
#include <cmath>

#include "apps/cli/context.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/progress.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "apps/simulation/matter_backend.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/statistics.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/saving.hpp"
#include "engine/matter/tool_body.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/simulation/scene_names.hpp"

namespace palpate {

namespace {

constexpr double kLongestDuration_s = 1e5;
constexpr double kMmPerMetre = 1e3;

struct SimulateOptions {
  std::string scene, model, probe, save, backend = "auto";
  double duration_s = 1;
};

Json summaryJson(const Summary& summary) {
  return {{"p50", summary.p50}, {"p99", summary.p99}, {"p999", summary.p999}, {"max", summary.max}};
}

// Throws Error with the failure and the remedy if the simulation has stopped.
void requireRunning(const MatterSimulation& world) {
  if (world.state() == MatterState::running) return;
  throw Error("the simulation {} after {:.3f} s; use more substeps",
              world.state() == MatterState::diverged ? "has diverged" : "has too many particles in one place",
              world.time_s());
}

void save(const std::string& file, MatterSimulation& world) {
  CloudFrame frame;
  world.makeFrame(frame);
  PointCloud cloud{.positions = std::move(frame.positions), .normals = std::move(frame.normals)};
  for (Vec3& position : cloud.positions) position *= static_cast<float>(kMmPerMetre);
  cloud.storedAs.comments.emplace_back("comment units: mm");
  saveKeeping(file, std::move(cloud));
}

MatterScene sceneOf(const SimulateOptions& options) {
  MatterScene scene = readSceneNamed(options.scene);
  if (options.model.empty()) return scene;
  scene.model = options.model;
  return scene;
}

// Prints and returns the forces on the standing model, if there is one.
Json sayModel(std::FILE* out, const MatterSimulation& world) {
  if (world.model() == nullptr) return nullptr;
  const double volume_cm3 = world.model()->volume_m3() * 1e6;
  const DVec3 force_N = world.onModel().force_N, impulse = world.impulses().onModel;
  const std::size_t inside = world.insideModel();
  fmt::print(out,
             "  model of {:.1f} cm^3: displaces {} particles, {} are inside; force on it {:.3g}, {:.3g}, {:.3g} N\n",
             volume_cm3, world.leftOut(), inside, force_N.x, force_N.y, force_N.z);
  return {{"volume_cm3", volume_cm3},
          {"left_out", world.leftOut()},
          {"inside", inside},
          {"force_N", vectorJson(force_N)},
          {"torque_Nm", vectorJson(world.onModel().torque_Nm)},
          {"impulse_kg_m_s", vectorJson(impulse)}};
}

// Prints the gain of the forces that a hand would feel, and the stiffness of the coupling to its ball; returns that
// stiffness.
Json sayHand(std::FILE* out, const MatterScene& scene) {
  if (scene.matter == Matter::soft) {
    fmt::print(out, "  force on a hand: {:g} times the simulated one\n", scene.gain);
    return nullptr;
  }
  MatterScene touched = scene;
  if (touched.tool.radius_mm == 0) touched.tool = usualTool(scene);
  const double coupling_N_mm = couplingStiffness_N_m(touched) * 1e-3;
  fmt::print(out, "  force on a hand: {:g} times the simulated one; spring between hand and ball {:.3g} N/mm\n",
             scene.gain, coupling_N_mm);
  return coupling_N_mm;
}

void simulate(Context& context, const SimulateOptions& options) {
  checkOutput(options.save, Output::points);
  sayWhatIsLost(options.save, context.log());
  const DVec3 probe_mm = options.probe.empty() ? DVec3(0) : parseVec3(options.probe, "--probe");
  const MatterScene scene = sceneOf(options);
  const std::string backend = chooseMatterBackend(context, options.backend);
  const auto simulation = startMatter(context, backend, scene);
  MatterSimulation& world = *simulation;
  const auto steps = static_cast<std::size_t>(std::llround(options.duration_s / kMatterStep_s));
  std::vector<double> step_us;
  double mostCompression = 0;
  Progress progress(context.log(), options.scene);
  const StopBySignal stop;  // until all results are written
  for (std::size_t k = 0; k < steps && !StopBySignal::requested(); ++k) {
    const Stopwatch watch;
    world.step();
    const double wall_us = watch.elapsed_us();
    step_us.push_back(world.gpuTime_us().value_or(wall_us));
    requireRunning(world);
    mostCompression = std::max(mostCompression, world.totals().maxCompression);
    progress.set(static_cast<double>(k + 1) / static_cast<double>(steps));
  }
  if (!options.save.empty()) save(options.save, world);
  const MatterObservation seen = world.observe();
  const Summary times = summarize(step_us);
  const bool hasPressure = !options.probe.empty() && scene.matter == Matter::water;
  const double pressure_Pa = hasPressure ? world.pressureAt(probe_mm / kMmPerMetre) : 0;
  std::FILE* out = context.tables();
  const bool isSoft = scene.matter == Matter::soft;
  fmt::print(out, "{}: {} {} of {}, {:.3f} s simulated, {} substeps per millisecond\n", options.scene, seen.particles,
             isSoft ? "nodes" : "particles", isSoft ? "a soft body" : nameOf(kMatters, scene.matter), seen.time_s,
             world.plan().substeps);
  fmt::print(out, "  {}\n", isSoft ? elasticityInWords(scene) : layersInWords(scene));
  const UVec3 layers = world.plan().lattice;
  const Json hand = sayHand(out, scene);
  fmt::print(out, "  {}: {:.0f} us per simulated millisecond (median), maximum {:.0f} us\n", backend, times.p50,
             times.max);
  fmt::print(out, "  kinetic energy {:.3g} J, potential {:.6g} J, largest compression {:.2f} %, front at {:.1f} mm\n",
             seen.kinetic_J, seen.potential_J, 100 * mostCompression, seen.front_m * kMmPerMetre);
  if (hasPressure) fmt::print(out, "  pressure at {} mm: {:.1f} Pa\n", options.probe, pressure_Pa);
  const Json model = sayModel(out, world);
  context.writeJson({{"time_s", seen.time_s},
                     {"backend", backend},
                     {"particles", seen.particles},
                     {"layers", isSoft ? Json(nullptr) : Json{layers.x, layers.y, layers.z}},
                     {"substeps", world.plan().substeps},
                     {"step_us", summaryJson(times)},
                     {"kinetic_J", seen.kinetic_J},
                     {"potential_J", seen.potential_J},
                     {"momentum_kg_m_s", vectorJson(seen.momentum)},
                     {"max_compression", mostCompression},
                     {"front_mm", seen.front_m * kMmPerMetre},
                     {"pressure_Pa", hasPressure ? Json(pressure_Pa) : Json(nullptr)},
                     {"gain", scene.gain},
                     {"coupling_N_mm", hand},
                     {"model", model}});
  if (step_us.size() < steps)
    throw Error("interrupted after {:.3f} of {:g} simulated seconds; the results until then are kept", seen.time_s,
                options.duration_s);
}

}  // namespace

void addSimulate(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("simulate", "simulate water, sand or a soft body without a hand");
  auto options = std::make_shared<SimulateOptions>();
  sub.add("scene", options->scene, "a JSON file, or " + builtInScenes())
      .required()
      .typeName("SCENE")
      .offers(builtInSceneNames());
  std::vector<std::string> backends = matterBackends();
  backends.insert(backends.begin(), "auto");
  sub.add("--backend", options->backend,
          "back end of the simulation: vulkan (a GPU), cpu, or auto (vulkan where there is a GPU, else "
          "cpu)")
      .check(oneOf(std::move(backends)))
      .showDefault();
  sub.add("--model", options->model,
          "closed cloud that stands in water or sand, or gives a soft body its surface, in place of the "
          "one of the scene; in water and sand also builtin:NAME, a shape of palpate make")
      .typeName("FILE");
  sub.add("--duration", options->duration_s, "simulated time, s").check(between(0, kLongestDuration_s)).showDefault();
  sub.add("--probe", options->probe, "position x,y,z at which the water pressure is reported at the end, mm");
  sub.add("--save", options->save,
          "write the final particles, or the surface of a soft body, mm: " +
              cloudFormats().endingsWritten(Written::points))
      .typeName("OUT.ply")
      .writes(Writes::keeping);
  sub.whenNamed([&, options] { command = [&context, options] { simulate(context, *options); }; });
}

}  // namespace palpate
