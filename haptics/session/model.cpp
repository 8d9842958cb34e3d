#include "haptics/session/model.hpp"

#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/matter/matter_model.hpp"
#include "engine/matter/soft_model.hpp"
#include "engine/touch/matter_touch.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/stream_model.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

std::string estimateNormalsOnCpu(PointCloud& cloud, unsigned threads) {
  constexpr std::size_t kNeighbours = 16;
  const Stopwatch watch;
  estimateNormals(cloud, kNeighbours, threads);
  return fmt::format("{:.0f} ms on the CPU", watch.elapsed_us() * 1e-3);
}

namespace {

/// Sets the properties that follow from the points.
void measure(Model& model, const ModelConfig& config, unsigned threads) {
  model.scale = scaleOf(model.cloud, config.mm_per_unit);
  // A saved copy states the scale.
  if (config.mm_per_unit > 0) sayScale(model.cloud.storedAs.comments, config.mm_per_unit);
  const SpacingRange spacing = spacingRange(model.cloud, threads);
  model.spacing = spacing.mean;
  model.wideSpacing = spacing.wide;
  model.noise = spacing.noise;
}

}  // namespace

std::optional<ModelScale> knownScaleOf(const PointCloud& cloud, double mm_per_unit) {
  if (mm_per_unit > 0) return ModelScale{mm_per_unit};
  const auto said = scaleSaidIn(cloud.storedAs.comments);
  if (said && *said >= bounds::kMinScale && *said <= bounds::kMaxScale) return ModelScale{*said};
  return std::nullopt;
}

ModelScale scaleOf(const PointCloud& cloud, double mm_per_unit) {
  return knownScaleOf(cloud, mm_per_unit).value_or(ModelScale::fitting(boundsOf(cloud).longestSide()));
}

namespace {

Model fetchModel(const ModelConfig& config, const ModelLoading& loading) {
  if (!loading.fetch) throw Error("{}: ROS topics are not supported here", config.file);
  if (config.normals == NormalSource::face)
    throw ConfigError("model.normals", "points from a ROS topic have no faces; take keep or estimate");
  return modelOf(loading.fetch(config.file, loading.log), config, loading);
}

}  // namespace

Model loadModel(const ModelConfig& config, const ModelLoading& loading) {
  if (isRosModel(config.file)) return fetchModel(config, loading);
  if (isRgbdFolder(config.file))
    throw FileError(config.file, "is a recorded depth camera, and not one cloud; touch, view, render and info read it");
  StoredCloud stored = readCloud(config.file, &loading.log,
                                 {.normalsFromFaces = config.normals == NormalSource::face,
                                  .pointsOnly = true,
                                  .keepUnreliable = config.keepUnreliable});
  if (!stored.leftOut.empty())
    loading.log.say("{}: left out are {}; all points can be requested", config.file, stored.leftOut);
  Model model = modelOf(std::move(stored.cloud), config, loading);
  model.cameras = std::move(stored.cameras);
  return model;
}

Model modelOf(PointCloud points, const ModelConfig& config, const ModelLoading& loading) {
  Model model{.cloud = std::move(points)};
  PointCloud& cloud = model.cloud;
  // Before normals are estimated, so that all programs that read the file find the same direction.
  model.upright = findUp(cloud);
  throwIfStopWanted();
  model.shown = coreBoundsOf(cloud);
  throwIfStopWanted();
  if (!cloud.hasNormals() || config.normals == NormalSource::estimate) {
    const std::string cost = loading.estimate(cloud, loading.threads);
    if (!cloud.empty()) loading.log.say("{}: normals are estimated from the points: {}", config.file, cost);
    // One or two points define no plane: their discs face the default view.
    constexpr std::size_t kNoPlane = 2;
    if (cloud.size() <= kNoPlane) cloud.normals.assign(cloud.size(), Vec3(frontOf(model.upright.up)));
  }
  measure(model, config, loading.threads);
  return model;
}

namespace {

Bounds boxOf(const MatterScene& scene) { return {.min = DVec3(0), .max = scene.box_mm}; }

// A scene's units are millimetres, also for the hand unless configured otherwise.
void placeInScene(Model& model, const MatterScene& scene) {
  sayScale(model.cloud.storedAs.comments, 1);
  model.upright = findUp(model.cloud);
  model.shown = boxOf(scene);
}

// Particles fill a body: their distances do not describe a surface.
FluidPoints drawnAsFluid(Model& model, const MatterScene& scene) {
  constexpr double kDisc_spacings = 0.85;  // two thirds would close a lattice at rest
  model.spacing = model.wideSpacing = particleSpacing_mm(scene);
  model.noise = 0;
  return {.container = boxOf(scene),
          .discRadius = kDisc_spacings * model.spacing,
          .ballRadius = scene.tool.radius_mm,
          .standing = nullptr};
}

// The initial state of a scene of water or sand.
Model matterModel(const SessionConfig& config, const ModelLoading& loading) {
  Model model;
  planOf(*config.matter);  // before a file is read
  std::shared_ptr<const MatterModel> standing = standingModel(*config.matter, loading);
  model.cloud = cloudOf(*config.matter, standing.get(), loading.threads);
  placeInScene(model, *config.matter);
  measure(model, config.model, loading.threads);
  FluidPoints fluid = drawnAsFluid(model, *config.matter);
  fluid.standing = std::move(standing);
  model.source = std::move(fluid);
  return model;
}

// A soft body at rest: the points of its surface, which are felt and drawn as any cloud's.
Model softModel(const SessionConfig& config, const ModelLoading& loading) {
  const MatterScene& scene = *config.matter;
  PointCloud scan;
  if (!scene.model.empty()) {
    planOf(scene);  // before the file is read
    scan = readCloud(scene.model, &loading.log, {.pointsOnly = true}).cloud;
  }
  const Stopwatch watch;
  Model model;
  const auto body = softModelOf(scene, std::move(scan), loading.threads);
  loading.log.say("{}: {} points are filled with {} nodes: {:.0f} ms", config.model.file, body->points.size(),
                  body->solid.lattice.nodes(), watch.elapsed_us() * 1e-3);
  model.cloud = cloudOf(*body, scene);
  model.source = SoftPoints{.container = boxOf(scene), .body = body};
  placeInScene(model, scene);
  measure(model, config.model, loading.threads);
  return model;
}

// Matter that another program simulates: takes the scene from its text, and the standing body from the points of its
// surface.
void takeFarMatter(Model& model, FarPoints& far, const FarFacts& facts, const ModelLoading& loading) {
  MatterScene scene = parseScene(facts.matter);
  if (scene.matter == Matter::soft)
    throw Error("matter: the served scene is a soft body, which must be served as a surface");
  if (facts.standing == 0) scene.model.clear();
  if (facts.standing > model.cloud.size()) throw Error("matter: points of the standing body are missing");
  far.scene = scene;
  model.shown = boxOf(scene);
  far.fluid = drawnAsFluid(model, scene);
  if (facts.standing == 0) return;
  PointCloud standing;
  const auto takeLast = [&](const auto& from, auto& to) {
    to.assign(from.end() - static_cast<std::ptrdiff_t>(facts.standing), from.end());
  };
  takeLast(model.cloud.positions, standing.positions);
  takeLast(model.cloud.normals, standing.normals);
  far.fluid.standing = std::make_shared<const MatterModel>(std::move(standing), scene, loading.threads);
}

// The server tells all properties that follow from points that are not here.
Model farModel(JoinedModel joined, const ModelConfig& config, const ModelLoading& loading) {
  const FarFacts& facts = *joined.facts;
  Model model{.cloud = std::move(joined.cloud)};
  model.scale = scaleOf(model.cloud, config.mm_per_unit);
  model.spacing = facts.spacing;
  model.wideSpacing = facts.wideSpacing;
  model.noise = facts.noise;
  model.upright = {.up = facts.up, .why = "as the server says"};
  model.shown = facts.extent.bounds;
  FarPoints far{.cloud = std::move(joined.far),
                .extent = facts.extent,
                .presence = std::move(joined.presence),
                .scene = std::nullopt,
                .fluid = {}};
  if (!facts.matter.empty()) takeFarMatter(model, far, facts, loading);
  model.source = std::move(far);
  return model;
}

}  // namespace

const FluidPoints* Model::fluid() const {
  if (const FarPoints* const far = as<FarPoints>()) return far->scene ? &far->fluid : nullptr;
  return as<FluidPoints>();
}

const Bounds* Model::container() const {
  if (const SoftPoints* const soft = as<SoftPoints>()) return &soft->container;
  return fluid() ? &fluid()->container : nullptr;
}

SharedPresence* Model::presence() const {
  if (const FarPoints* const far = as<FarPoints>()) return far->presence.get();
  return as<JoinedPoints>() ? as<JoinedPoints>()->presence.get() : nullptr;
}

std::shared_ptr<const MatterModel> standingModel(const MatterScene& scene, const ModelLoading& loading) {
  if (scene.model.empty()) return nullptr;
  PointCloud cloud = isBuiltInModel(scene.model) ? builtInModel(scene, loading.threads)
                                                 : readCloud(scene.model, &loading.log, {.pointsOnly = true}).cloud;
  const Stopwatch watch;
  const std::size_t points = cloud.size();
  auto model = std::make_shared<const MatterModel>(std::move(cloud), scene, loading.threads);
  loading.log.say("{}: {} points are a field of {} nodes: {:.0f} ms", scene.model, points, model->nodes().size(),
                  watch.elapsed_us() * 1e-3);
  return model;
}

Model loadModel(const SessionConfig& config, const ModelLoading& loading) {
  if (config.matter)
    return config.matter->matter == Matter::soft ? softModel(config, loading) : matterModel(config, loading);
  if (config.join) {
    if (!loading.join) throw Error("{}: this program cannot join sessions", config.model.file);
    JoinedModel joined = loading.join(config.model.file, *config.join, loading.log);
    if (joined.far) return farModel(std::move(joined), config.model, loading);
    Model model = modelOf(std::move(joined.cloud), config.model, loading);
    model.source = JoinedPoints{.share = std::move(joined.share), .presence = std::move(joined.presence)};
    return model;
  }
  if (!config.stream) return loadModel(config.model, loading);
  FirstFrame first = readFirstFrame(config, loading);
  Model model;
  model.cloud = std::move(first.cloud);
  model.source = CameraPoints{.stream = std::move(first.stream)};
  if (first.camera) model.cameras = {*first.camera};
  model.upright = findUp(model.cloud);
  model.shown = coreBoundsOf(model.cloud);
  measure(model, config.model, loading.threads);
  return model;
}

std::uint64_t checksumOf(const Model& model) { return checksumOf(model.cloud.origin, statesOf(model.cloud)); }

double usualSupportRadius(const Model& model) {
  if (model.spacing > 0) return static_cast<double>(shared::kSupportSpacings) * model.spacing;
  return model.scale.toUnits(1.0);  // nothing to measure: any length is suitable
}

SurfaceOptions surfaceOptions(const Model& model, const SurfaceConfig& config, bool adapts) {
  // An even cloud needs no local spacing; beyond four times the mean, a patch of the dense parts is too large.
  constexpr double kUneven = 1.4, kWidest = 4;
  SurfaceOptions surface{
      .radius = config.radius_mm ? model.scale.toUnits(*config.radius_mm) : usualSupportRadius(model),
      .kind = config.kind};
  if (config.radius_mm || !adapts) return surface;
  surface.widening = wideningFor(model.noise);
  surface.localRadius = model.wideSpacing > kUneven * model.spacing;
  if (surface.localRadius) surface.radius *= std::min(kWidest / surface.widening, model.wideSpacing / model.spacing);
  surface.radius *= surface.widening;
  return surface;
}

double cellFor(const Model& model, const IndexConfig& config) {
  if (config.cell_mm > 0) return model.scale.toUnits(config.cell_mm);
  if (config.cellsAlongSide > 0) return boundsOf(model.cloud).longestSide() / config.cellsAlongSide;
  return 0;
}

}  // namespace palpate
