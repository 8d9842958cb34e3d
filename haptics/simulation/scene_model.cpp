#include "haptics/simulation/scene_model.hpp"

#include <utility>

#include "engine/cloud/length_unit.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/matter/matter_touch.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/simulation/matter_choice.hpp"

namespace palpate {

namespace {

/// A body as the model of a session keeps it.
template <class Body>
struct KeptBody final : SceneBody {
  explicit KeptBody(std::shared_ptr<const Body> kept) : body(std::move(kept)) {}
  std::shared_ptr<const Body> body;
};

template <class Body>
std::shared_ptr<const SceneBody> kept(std::shared_ptr<const Body> body) {
  return std::make_shared<const KeptBody<Body>>(std::move(body));
}

template <class Body>
std::shared_ptr<const Body> bodyIn(const std::shared_ptr<const SceneBody>& kept) {
  return kept ? static_cast<const KeptBody<Body>&>(*kept).body : nullptr;
}

void setStanding(FluidPoints& fluid, std::shared_ptr<const MatterModel> standing) {
  if (!standing) return;
  fluid.standing = standing->points().size();
  fluid.body = kept(std::move(standing));
}

Bounds boxOf(const MatterScene& scene) { return {.min = DVec3(0), .max = scene.box_mm}; }

// A scene's units are millimetres, also for the hand unless configured otherwise.
void placeInScene(Model& model, const MatterScene& scene) {
  sayScale(model.cloud.storedAs.comments, 1);
  model.upright = findUp(model.cloud);
  model.shown = boxOf(scene);
}

// Particles fill a body: their distances do not describe a surface.
FluidPoints drawnAsFluid(Model& model, const MatterScene& scene) {
  model.spacing = model.wideSpacing = particleSpacing_mm(scene);
  model.noise = 0;
  return {.container = boxOf(scene),
          .isWater = scene.matter == Matter::water,
          .discRadius = kParticleRadius_spacings * model.spacing,
          .ballRadius = scene.tool.radius_mm,
          .body = nullptr};
}

// The initial state of a scene of water or sand.
Model matterModel(const MatterScene& scene, const ModelConfig& config, const ModelLoading& loading) {
  Model model;
  planOf(scene);  // before a file is read
  std::shared_ptr<const MatterModel> standing = standingModel(scene, loading);
  model.cloud = cloudOf(scene, standing.get(), loading.threads);
  placeInScene(model, scene);
  measure(model, config, loading.threads);
  FluidPoints fluid = drawnAsFluid(model, scene);
  setStanding(fluid, std::move(standing));
  model.source = std::move(fluid);
  return model;
}

// A soft body at rest: the points of its surface, which are felt and drawn as any cloud's.
Model softModel(const MatterScene& scene, const ModelConfig& config, const ModelLoading& loading) {
  PointCloud scan;
  if (!scene.model.empty()) {
    planOf(scene);  // before the file is read
    scan = readCloud(scene.model, &loading.log, {.pointsOnly = true, .memory = {loading.exceeds}}).cloud;
  }
  const Stopwatch watch;
  Model model;
  const auto body = softModelOf(scene, std::move(scan), loading.threads);
  loading.log.say("{}: a body of {}, filled with {} in {:.0f} ms", config.file, counted(body->points.size(), "point"),
                  counted(body->solid.lattice.nodes(), "node"), watch.elapsed_us() * 1e-3);
  model.cloud = cloudOf(*body, scene);
  model.source = SoftPoints{.container = boxOf(scene), .body = kept(body)};
  placeInScene(model, scene);
  measure(model, config, loading.threads);
  return model;
}

}  // namespace

Model sceneModel(const MatterScene& scene, const ModelConfig& config, const ModelLoading& loading) {
  return scene.matter == Matter::soft ? softModel(scene, config, loading) : matterModel(scene, config, loading);
}

void takeFarScene(Model& model, FarPoints& far, const FarFacts& facts, const ModelLoading& loading) {
  const SceneRef told = parseScene("matter", facts.matter);
  validate(SessionConfig{.model = {.matter = told}});
  MatterScene scene = matterOf(told);
  if (scene.matter == Matter::soft)
    throw Error("matter: the served scene is a soft body, which must be served as a surface");
  if (facts.standing == 0) scene.model.clear();
  if (facts.standing > model.cloud.size()) throw Error("matter: points of the standing body are missing");
  far.scene = sceneRef(scene);
  model.shown = boxOf(scene);
  far.fluid = drawnAsFluid(model, scene);
  if (facts.standing == 0) return;
  PointCloud standing;
  const auto takeLast = [&](const auto& from, auto& to) {
    to.assign(from.end() - static_cast<std::ptrdiff_t>(facts.standing), from.end());
  };
  takeLast(model.cloud.positions, standing.positions);
  takeLast(model.cloud.normals, standing.normals);
  setStanding(far.fluid, std::make_shared<const MatterModel>(std::move(standing), scene, loading.threads));
}

std::shared_ptr<const MatterModel> standingModel(const MatterScene& scene, const ModelLoading& loading) {
  if (scene.model.empty()) return nullptr;
  PointCloud cloud =
      isBuiltInModel(scene.model)
          ? builtInModel(scene, loading.threads)
          : readCloud(scene.model, &loading.log, {.pointsOnly = true, .memory = {loading.exceeds}}).cloud;
  const Stopwatch watch;
  const std::size_t points = cloud.size();
  auto model = std::make_shared<const MatterModel>(std::move(cloud), scene, loading.threads);
  loading.log.say("{}: a solid of {}, as a field of {} in {:.0f} ms", scene.model, counted(points, "point"),
                  counted(model->nodes().size(), "node"), watch.elapsed_us() * 1e-3);
  return model;
}

std::shared_ptr<const MatterModel> standingOf(const Model& model) {
  return model.fluid() ? bodyIn<MatterModel>(model.fluid()->body) : nullptr;
}

std::shared_ptr<const SoftModel> softBodyOf(const Model& model) {
  const SoftPoints* const soft = model.as<SoftPoints>();
  return soft ? bodyIn<SoftModel>(soft->body) : nullptr;
}

}  // namespace palpate
