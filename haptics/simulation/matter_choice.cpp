#include "haptics/simulation/matter_choice.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/core/named_values.hpp"
#include "engine/matter/matter_parameters.hpp"
#include "engine/matter/matter_scene_file.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/matter_touch.hpp"
#include "engine/matter/soft_scene.hpp"
#include "engine/matter/soft_touch.hpp"
#include "engine/matter/tool_body.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/simulation/scene_model.hpp"
#include "haptics/simulation/scene_names.hpp"
#include "haptics/simulation/simulator.hpp"

namespace palpate {

namespace {

// Matter without hands, for programs.

constexpr double kMmPerMetre = 1e3;

class MatterRun final : public FreeSimulation {
 public:
  explicit MatterRun(std::unique_ptr<MatterSimulation> world) : world_(std::move(world)) {}

  void step() override { world_->step(); }
  void reset() override { world_->reset(); }
  double time_s() const override { return world_->time_s(); }
  std::uint32_t substeps() const override { return world_->plan().substeps; }
  std::string failure() const override {
    if (world_->state() == MatterState::running) return {};
    return world_->state() == MatterState::diverged ? "has diverged" : "has too many particles in one place";
  }
  std::vector<SimulationParameter> parameters() const override { return parametersOf(world_->scene()); }
  void setParameter(std::string_view name, double value) override {
    MatterScene scene = world_->scene();
    palpate::setParameter(scene, name, value);
    world_->change(scene);
  }
  CloudFrame frame() override {
    CloudFrame now;
    world_->makeFrame(now);
    for (Vec3& position : now.positions) position *= static_cast<float>(kMmPerMetre);
    for (Vec3& velocity : now.velocities) velocity *= static_cast<float>(kMmPerMetre);
    now.velocities.resize(now.size(), Vec3(0));
    now.time_s = world_->time_s();
    return now;
  }
  Totals totals() const override {
    const MatterObservation seen = world_->observe();
    Totals totals{.kinetic_J = seen.kinetic_J,
                  .potential_J = seen.potential_J,
                  .momentum_kg_m_s = seen.momentum,
                  .maxCompression = seen.maxCompression,
                  .front_mm = kMmPerMetre * seen.front_m,
                  .particles = seen.particles};
    if (!world_->model()) return totals;
    totals.insideModel = world_->insideModel();
    totals.onModel_N = world_->onModel().force_N;
    return totals;
  }

 private:
  std::unique_ptr<MatterSimulation> world_;
};

std::unique_ptr<FreeSimulation> runFreely(std::unique_ptr<MatterSimulation> world) {
  return std::make_unique<MatterRun>(std::move(world));
}

// Simulated matter that hands touch.

// A soft body, whose points are felt as those of any moving cloud.
std::unique_ptr<TouchBackend> touchSoft(const MatterScene& scene, const BackendKind& backend,
                                        const BackendRequest& request) {
  // Maximum number of steps per frame in real time: more would only delay the answers further.
  constexpr std::uint32_t kMaxAtOnce = 4;
  MatterOptions options{.threads = request.threads};
  options.soft = softBodyOf(request.model);
  double reach = 0;
  for (const ToolPoint& point : request.tools.front().points) reach = std::max(reach, glm::length(point.place));
  auto world = simulatorOf(backend).simulate(scene, options);
  auto source = std::make_unique<SoftSource>(std::move(world), SoftSourceOptions{.points = request.model.cloud.size(),
                                                                                 .hands = request.tools.size(),
                                                                                 .radius = request.surface.radius,
                                                                                 .toolReach = reach,
                                                                                 .mostAtOnce = kMaxAtOnce});
  BackendRequest felt = request;
  felt.source = source.get();
  felt.brush.reset();  // the body has the brush, and its points follow
  felt.paintable = false;
  auto surface = backend.make(felt);
  return std::make_unique<SoftTouch>(
      std::move(source), std::move(surface),
      SoftTouchOptions{.tools = request.tools, .friction = request.config.surface.friction, .brush = request.brush});
}

/// Makes a simulation on that back end, with a hand for each tool of the request. Throws Error.
std::unique_ptr<TouchBackend> touchMatter(const MatterScene& scene, const BackendKind& backend,
                                          const BackendRequest& request) {
  if (scene.matter == Matter::soft) return touchSoft(scene, backend, request);
  const std::size_t hands = request.tools.size();
  return std::make_unique<MatterTouch>(
      simulatorOf(backend).simulate(scene,
                                    {.threads = request.threads, .tools = hands, .model = standingOf(request.model)}),
      MatterTouchOptions{.hands = hands,
                         .threads = request.threads,
                         .realtime = request.config.realtime,
                         .machine = backend.machine(request.threads)});
}

// A brush smaller than a cell has no cell of its own to move.
void checkBrush(const BrushConfig& brush, const MatterScene& scene, double mm_per_unit) {
  const double least_mm = scene.spacing_mm * (mm_per_unit > 0 ? mm_per_unit : 1);
  if (brush.radius_mm < least_mm)
    throw ConfigError("brush.radius_mm",
                      "is {:g}; the cells of the body are {:g} mm wide, and the brush must not be smaller",
                      brush.radius_mm, least_mm);
}

void checkPlan(const MatterScene& scene, std::uint64_t memory_bytes) {
  try {
    planOf(scene, memory_bytes);
  } catch (const Error& error) {
    throw ConfigError("matter", "{}", error.what());
  }
}

class MatterChoice final : public SimulatedScene {
 public:
  explicit MatterChoice(MatterScene scene) : scene_(std::move(scene)) {}

  const MatterScene& scene() const { return scene_; }
  bool equals(const SimulatedScene& other) const override {
    return scene_ == static_cast<const MatterChoice&>(other).scene_;
  }

  bool isSoft() const override { return scene_.matter == Matter::soft; }
  SceneReport report() const override {
    SceneReport report{
        .matter = nameOf(kMatters, scene_.matter), .substeps = planOf(scene_).substeps, .gain = scene_.gain};
    if (isSoft())
      report.elasticity = elasticityInWords(scene_);
    else
      report.coupling_N_mm = 1e-3 * couplingStiffness_N_m(scene_);
    return report;
  }
  BodyStiffness stiffness(double radius_mm) const override {
    if (!isSoft()) return {.why = "water and sand have none"};
    return {.N_per_mm = scene_.gain * 1e-3 / halfSpaceCompliance_m_N(scene_, 1e-3 * radius_mm), .why = {}};
  }
  std::string text() const override { return textOf(scene_); }
  std::string servedText() const override {
    if (isSoft()) return {};
    MatterScene served = scene_;
    served.model = std::filesystem::path(served.model).filename().string();
    return textOf(served);
  }
  SceneRef with(std::string_view parameter, double value) const override {
    MatterScene changed = scene_;
    setParameter(changed, parameter, value);
    return sceneRef(std::move(changed));
  }

  void check(const SessionConfig& config) const override {
    checkPlan(scene_, kAnyMemory);
    if (scene_.periodic != MatterScene{}.periodic)
      throw ConfigError("matter.periodic", "requires a simulation without a hand");
    if (config.model.stream) throw ConfigError("stream", "the model is a scene of matter; leave it out");
    if (isSoft()) {
      if (config.brush) checkBrush(*config.brush, scene_, config.model.mm_per_unit);
      if (!(scene_.gain > 0)) throw ConfigError("matter.gain", "is 0; pressing a soft body requires more");
      return;
    }
    if (scene_.tool.radius_mm == 0) throw ConfigError("matter.tool.radius_mm", "is 0; the hand requires a ball");
    if (config.tool.kind != ToolKind::point) throw ConfigError("tool.kind", "in matter a hand holds the scene's ball");
  }
  void check(const BackendKind& backend) const override { checkPlan(scene_, simulatorOf(backend).memory_bytes()); }
  Model load(const ModelConfig& config, const ModelLoading& loading) const override {
    return sceneModel(scene_, config, loading);
  }
  std::unique_ptr<TouchBackend> touch(const BackendKind& backend, const BackendRequest& request) const override {
    return touchMatter(scene_, backend, request);
  }
  std::unique_ptr<FreeSimulation> run(const BackendKind& backend, const std::string& name,
                                      const ModelLoading& loading) const override {
    const MatterSimulator& simulator = simulatorOf(backend);
    planOf(scene_, simulator.memory_bytes());  // before a file is read
    const Model model = load({.file = name}, loading);
    MatterOptions options{.threads = loading.threads, .model = standingOf(model)};
    options.soft = softBodyOf(model);
    return runFreely(simulator.simulate(scene_, options));
  }

 private:
  static std::string textOf(const MatterScene& scene) {
    SettingsJson json;
    writeSettings(json, sceneSettings(), scene);
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  MatterScene scene_;
};

}  // namespace

SceneRef sceneRef(MatterScene scene) { return SceneRef(std::make_shared<const MatterChoice>(std::move(scene))); }

const MatterScene& matterOf(const SceneRef& scene) {
  return static_cast<const MatterChoice&>(*scene).scene();  // all scenes are made here
}

SceneRef parseScene(std::string_view path, std::string_view text) {
  const SettingsJson json = SettingsJson::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error("{}: is not valid JSON", path);
  return sceneRef(readScene(path, json));
}

}  // namespace palpate
