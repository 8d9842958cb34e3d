#include "engine/matter/soft_model.hpp"

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/matter/soft_scan.hpp"
#include "engine/matter/soft_scene.hpp"

namespace palpate {

namespace {

constexpr int kPointsOfSpacing = 3;  // points along a cell spacing
constexpr std::size_t kPointsOfSculpture = 20'000;
constexpr float kMmPerMetre = 1e3f;

std::shared_ptr<const SoftModel> filled(const MatterScene& scene, PointCloud scan, unsigned threads) {
  std::vector<SurfacePlace> points = placeScan(std::move(scan), scene, threads);
  WorkerTeam team(threads);
  SoftSolid solid = scanSolid(points, scene.spacing_mm * 1e-3, scene.hole_mm * 1e-3, team);
  return std::make_shared<const SoftModel>(SoftModel{.solid = std::move(solid), .points = std::move(points)});
}

SoftModel boxModel(const MatterScene& scene) {
  const auto [low, high] = standOf(scene);
  const double spacing = scene.spacing_mm * 1e-3;
  return {.solid = boxSolid(low, high - low, spacing),
          .points = boxSurface(low, high - low, spacing, kPointsOfSpacing)};
}

SoftModel ballModel(const MatterScene& scene) {
  const auto [middle, radius] = ballOf(scene);
  const double spacing = scene.spacing_mm * 1e-3;
  return {.solid = ballSolid(middle, radius, spacing),
          .points = ballSurface(middle, radius, spacing, kPointsOfSpacing)};
}

}  // namespace

std::shared_ptr<const SoftModel> softModelOf(const MatterScene& scene, PointCloud scan, unsigned threads) {
  PALPATE_CHECK(scene.matter == Matter::soft);
  planOf(scene);
  if (!scene.model.empty()) return filled(scene, std::move(scan), threads);
  switch (scene.shape) {
    case SoftShape::sculpture:
      return filled(scene, sampleShape(*makeShape("sculpture"), {.count = kPointsOfSculpture, .threads = threads}),
                    threads);
    case SoftShape::ball:
      return std::make_shared<const SoftModel>(ballModel(scene));
    case SoftShape::box:
      break;
  }
  return std::make_shared<const SoftModel>(boxModel(scene));
}

std::shared_ptr<const SoftModel> softModelFor(const MatterScene& scene, const MatterOptions& options) {
  if (options.soft) return options.soft;
  planOf(scene, options.memory_bytes > 0 ? options.memory_bytes : kAnyMemory);
  return softModelOf(scene, {}, options.threads);
}

std::shared_ptr<const SoftModel> softModelOf(SoftSolid solid, std::span<const SurfacePlace> points) {
  std::vector<SurfacePlace> carried(points.begin(), points.end());
  if (carried.empty()) carried = solid.surface;
  return std::make_shared<const SoftModel>(SoftModel{.solid = std::move(solid), .points = std::move(carried)});
}

SoftSolid solidOf(const MatterScene& scene, std::uint64_t memory_bytes) {
  return softModelFor(scene, {.memory_bytes = memory_bytes})->solid;
}

PointCloud cloudOf(const SoftModel& model, const MatterScene& scene) {
  PointCloud cloud;
  cloud.positions.reserve(model.points.size());
  cloud.normals.reserve(model.points.size());
  for (const SurfacePlace& point : model.points) {
    cloud.positions.push_back(kMmPerMetre * point.rest);
    cloud.normals.push_back(point.normal);
  }
  cloud.storedAs.comments = {"comment units: mm"};
  const double gravity = glm::length(scene.gravity_m_s2);
  if (const auto up = upOfCameras(gravity > 0 ? -scene.gravity_m_s2 / gravity : DVec3(0, 1, 0)))
    cloud.storedAs.comments.push_back(fmt::format("comment up: {}", nameOf(*up)));
  return cloud;
}

}  // namespace palpate
