// Clouds and motions shared by tests and measurements.
#pragma once

#include <random>
#include <string_view>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"

namespace palpate {

/// A shape, a sampling of it, and a support radius for the sampling.
struct Scene {
  std::unique_ptr<AnalyticShape> shape;
  PointCloud cloud;
  double spacing = 0;
  double radius = 0;
};

inline Scene makeScene(std::string_view name, std::size_t count, const DVec3& center = DVec3(0), double noise = 0) {
  Scene scene{.shape = makeShape(name, 100.0, center)};
  scene.cloud = sampleShape(*scene.shape, {.count = count, .seed = 7, .noise = noise});
  scene.spacing = meanSpacing(scene.cloud);
  scene.radius = 4 * scene.spacing;
  return scene;
}

/// Positions of a probe that wanders over a shape, in and out of it by up to `depth`, in file coordinates, starting
/// outside.
inline std::vector<DVec3> wanderingPath(const Scene& scene, std::size_t ticks, double depth, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return glm::normalize(DVec3{normal(random), normal(random), normal(random)}); };
  const auto start = scene.cloud.empty() ? 0 : random() % scene.cloud.size();
  DVec3 on = scene.cloud.fileCoordinates(start);
  DVec3 heading = direction();
  std::vector<DVec3> path;
  for (std::size_t i = 0; i < ticks; ++i) {
    const SurfacePoint surface = scene.shape->closest(on);
    const double phase = static_cast<double>(i) * 0.05;
    path.push_back(surface.position + surface.normal * (depth * (0.2 + std::cos(phase))));
    heading = glm::normalize(heading + 0.2 * direction());
    heading = glm::normalize(heading - glm::dot(heading, surface.normal) * surface.normal);
    on = surface.position + 0.1 * scene.radius * heading;
  }
  return path;
}

}  // namespace palpate
