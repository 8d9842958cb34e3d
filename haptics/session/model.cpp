#include "haptics/session/model.hpp"

#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/estimated_normals.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/io/saving.hpp"
#include "engine/select/normal_signs.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/settings.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/session/stream_model.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

std::string estimateNormalsOnCpu(PointCloud& cloud, unsigned threads, std::optional<UpAxis> up) {
  constexpr std::size_t kNeighbours = 16;
  const Stopwatch watch;
  estimateNormals(cloud, kNeighbours, threads, up);
  return fmt::format("{:.0f} ms on the CPU", watch.elapsed_us() * 1e-3);
}

void measure(Model& model, const ModelConfig& config, unsigned threads) {
  model.scale = scaleOf(model, config.mm_per_unit);
  // A saved copy states the scale.
  if (config.mm_per_unit > 0) sayScale(model.cloud.storedAs.comments, config.mm_per_unit);
  const SpacingRange spacing = spacingRange(model.cloud, threads);
  model.spacing = spacing.mean;
  model.wideSpacing = spacing.wide;
  model.noise = spacing.noise;
}

std::optional<ModelScale> knownScaleOf(const PointCloud& cloud, double mm_per_unit) {
  if (mm_per_unit > 0) return ModelScale{mm_per_unit};
  const std::vector<std::string>& comments = cloud.storedAs.comments;
  const auto scale = scaleSaidIn(comments), said = scale ? scale : touchScaleSaidIn(comments);
  if (said && *said >= bounds::kMinScale && *said <= bounds::kMaxScale) return ModelScale{*said};
  return std::nullopt;
}

ModelScale scaleOf(const Model& model, double mm_per_unit) {
  return knownScaleOf(model.cloud, mm_per_unit).value_or(ModelScale::fitting(model.shownBounds().longestSide()));
}

namespace {

/// Returns PreparedCloud::upright.
std::optional<Upright> prepare(PointCloud& cloud, const ModelConfig& config, const ModelLoading& loading) {
  const FieldOptions fields{.mm_per_unit = mmPerUnit(cloud, config.mm_per_unit),
                            .up = {},
                            .threads = loading.threads,
                            .progress = [&](double share) { loading.log.progress("select and clean", share); }};
  PreparedCloud result = prepared(std::move(cloud), *config.prepare, fields, [&](const PreparedStep& step) {
    loading.log.say("{}: {} {}", config.file, flagOf(step.name), step.what);
    if (step.after == 0) throw Error("{}: {} {}; no point is left", config.file, flagOf(step.name), step.what);
  });
  loading.log.endProgress();
  cloud = std::move(result.cloud);
  return std::move(result.upright);
}

Model fetchModel(const ModelConfig& config, const ModelLoading& loading) {
  if (!loading.fetch) throw Error("{}: ROS topics are not supported here", config.file);
  if (config.normals == NormalSource::face)
    throw ConfigError("model.normals", "points from a ROS topic have no faces; use keep or estimate");
  return modelOf(loading.fetch(config.file, loading.log), config, loading);
}

// States, history and index of a point, measured on the CPU; a GPU has its own memory.
constexpr std::uint64_t kSessionPerPoint_bytes = 130;

Model readModel(const ModelConfig& config, const ModelLoading& loading) {
  if (isRosModel(config.file)) return fetchModel(config, loading);
  if (isRgbdFolder(config.file))
    throw FileError(config.file, "is a recorded depth camera, and not one cloud; touch, view, render and info read it");
  StoredCloud stored = readCloud(config.file, &loading.log,
                                 {.normalsFromFaces = config.normals == NormalSource::face,
                                  .pointsOnly = true,
                                  .keepUnreliable = config.keepUnreliable,
                                  .memory = {loading.exceeds, kSessionPerPoint_bytes}});
  markNormalsAsEstimated(stored.cloud, false);  // whatever a comment in the file says: they are its own
  if (!stored.leftOut.empty())
    loading.log.warn("{}: left out: {}; the setting keep_unreliable keeps them", config.file, stored.leftOut);
  std::optional<Upright> ofWhole;
  if (config.prepare && !stored.cloud.empty()) ofWhole = prepare(stored.cloud, config, loading);
  Model model = modelOf(std::move(stored.cloud), config, loading);
  if (ofWhole) model.upright = *std::move(ofWhole);
  model.cameras = std::move(stored.cameras);
  return model;
}

}  // namespace

Model modelOf(PointCloud points, const ModelConfig& config, const ModelLoading& loading) {
  Model model{.cloud = std::move(points)};
  PointCloud& cloud = model.cloud;
  // Before normals are estimated, so that all programs that read the file find the same direction.
  model.upright = findUp(cloud);
  throwIfStopWanted();
  model.shown = coreBoundsOf(cloud);
  throwIfStopWanted();
  if (!cloud.hasNormals() || config.normals == NormalSource::estimate) {
    markNormalsAsEstimated(cloud, config.normals != NormalSource::estimate);
    const std::string cost = loading.estimate(cloud, loading.threads, {});
    if (!cloud.empty()) loading.log.say("{}: normals are estimated from the points: {}", config.file, cost);
    // One or two points define no plane: their discs face the default view.
    constexpr std::size_t kNoPlane = 2;
    if (cloud.size() <= kNoPlane) cloud.normals.assign(cloud.size(), Vec3(frontOf(model.upright.up)));
    // Only normals show that a room was scanned from inside, and where its furniture stands.
    if (Upright seen = findUp(cloud); seen.isInterior) model.upright = std::move(seen);
  } else if (config.normals == NormalSource::orient) {
    orientNormals(cloud, loading.threads);
  }
  if (config.normals == NormalSource::flip) flipNormals(cloud);
  measure(model, config, loading.threads);
  return model;
}

namespace {

// The server tells all properties that follow from points that are not here.
Model farModel(JoinedModel joined, const ModelConfig& config, const ModelLoading& loading) {
  const FarFacts& facts = *joined.facts;
  Model model{.cloud = std::move(joined.cloud)};
  model.spacing = facts.spacing;
  model.wideSpacing = facts.wideSpacing;
  model.noise = facts.noise;
  model.upright = {
      .up = facts.up, .why = "as the server says", .sureness = Sureness::known, .front = frontOf(facts.up)};
  model.shown = facts.extent.bounds;
  model.scale = scaleOf(model, config.mm_per_unit);
  FarPoints far{.cloud = std::move(joined.far),
                .extent = facts.extent,
                .presence = std::move(joined.presence),
                .scene = {},
                .fluid = {}};
  if (!facts.matter.empty()) takeFarScene(model, far, facts, loading);
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

Model loadModel(const ModelConfig& config, const ModelLoading& loading) {
  if (config.matter) return config.matter->load(config, loading);
  if (config.join) {
    if (!loading.join) throw Error("{}: this program cannot join sessions", config.file);
    JoinedModel joined = loading.join(config.file, *config.join, loading.log);
    if (joined.far) return farModel(std::move(joined), config, loading);
    Model model = modelOf(std::move(joined.cloud), config, loading);
    model.source = JoinedPoints{.share = std::move(joined.share), .presence = std::move(joined.presence)};
    return model;
  }
  if (!config.stream) return readModel(config, loading);
  FirstFrame first = readFirstFrame(config, loading);
  Model model;
  model.cloud = std::move(first.cloud);
  model.source = CameraPoints{.stream = std::move(first.stream)};
  if (first.camera) model.cameras = {*first.camera};
  model.upright = findUp(model.cloud);
  model.shown = coreBoundsOf(model.cloud);
  measure(model, config, loading.threads);
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

}  // namespace palpate
