// Scenes of Gaussians with a known true surface and the statistics of trained scenes.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/gaussian_scene.hpp"

namespace palpate::test {

struct SceneOptions {
  std::size_t count = 20'000;  ///< Gaussians on the surface
  double floaters = 0;         ///< fraction of additional, isolated Gaussians off the surface
  double faint = 0;            ///< fraction of additional Gaussians all over the box around it
  std::size_t huge = 0;        ///< Gaussians as large as the shape
  double offset = 0;           ///< deviation of the centres off the surface, spacings of the Gaussians
  std::uint64_t seed = 1;
};

struct KnownScene {
  GaussianScene scene;
  double spacing = 0;  ///< of the Gaussians on the surface, model units
  std::vector<DVec3> floaters;
};

/// A sequence of random numbers in separate calls, so that argument evaluation order does not matter.
class SceneRandom {
 public:
  explicit SceneRandom(std::uint64_t seed) : random_(seed) {}
  double unit() { return std::uniform_real_distribution<double>()(random_); }
  double normal() { return std::normal_distribution<double>()(random_); }
  DVec3 inBox(const DVec3& center, double side) {
    const double x = unit(), y = unit(), z = unit();
    return center + side * (DVec3(x, y, z) - 0.5);
  }
  DVec3 direction() {
    const double x = normal(), y = normal(), z = normal();
    return glm::normalize(DVec3(x, y, z));
  }

 private:
  std::mt19937_64 random_;
};

inline float logitOf(double opacity) { return static_cast<float>(std::log(opacity / (1 - opacity))); }

/// A quaternion of random length that rotates z to `normal` and x to a random direction around it.
inline Vec4 rotationTo(const DVec3& normal, SceneRandom& random) {
  const double half = std::numbers::pi * random.unit();
  const DVec3 axis = glm::cross(DVec3(0, 0, 1), normal);
  const bool opposite = normal.z < -1 + 1e-9;
  const DQuat tilt = opposite ? DQuat(0, 1, 0, 0) : glm::normalize(DQuat(1 + normal.z, axis.x, axis.y, axis.z));
  const DQuat q = tilt * DQuat(std::cos(half), 0, 0, std::sin(half));
  const double length = 0.6 + 0.6 * random.unit();
  return Vec4(DVec4(q.w, q.x, q.y, q.z) * length);
}

inline void addGaussian(GaussianScene& scene, const DVec3& center, const DVec3& deviations, const Vec4& rotation,
                        double opacity, const DVec3& color) {
  scene.centers.push_back(center);
  scene.logScales.emplace_back(glm::log(deviations));
  scene.rotations.push_back(rotation);
  scene.opacityLogits.push_back(logitOf(opacity));
  scene.colorHarmonics.emplace_back((color - 0.5) / 0.28209479177387814);
}

/// `area`: of the shape's surface. Colours are red for high x, green for high y.
inline KnownScene gaussiansOn(const AnalyticShape& shape, double area, const SceneOptions& options) {
  KnownScene known;
  known.spacing = std::sqrt(area / static_cast<double>(options.count));
  SceneRandom random(options.seed);
  GaussianScene& scene = known.scene;
  const PointCloud even = sampleShape(shape, {.count = options.count, .seed = options.seed});
  const double usual = 0.75 * known.spacing;
  for (std::size_t i = 0; i < even.size(); ++i) {
    const DVec3 normal(even.normals[i]);
    const DVec3 center = even.fileCoordinates(i) + options.offset * known.spacing * random.normal() * normal;
    const double middle = usual * std::exp(0.3 * random.normal());
    const double longest = middle * (1 + 0.5 * random.unit());
    const double shortest = middle * std::min(0.95, 0.59 * std::exp(0.3 * random.normal()));
    const double opacity = 0.5 + 0.49 * random.unit();
    const Vec4 rotation = rotationTo(normal, random);
    const DVec3 color = 0.5 + 0.5 * (DVec3(even.positions[i]) + even.origin - shape.center()) / shape.size();
    addGaussian(scene, center, {longest, middle, shortest}, rotation, opacity, {color.x, color.y, 0.25});
  }
  const auto extra = [&](double share) { return static_cast<std::size_t>(share * static_cast<double>(options.count)); };
  for (std::size_t i = 0; i < extra(options.floaters);) {
    const DVec3 place = random.inBox(shape.center(), 2 * shape.size());
    if (std::abs(shape.signedDistance(place)) < 8 * known.spacing) continue;
    const double radius = usual * (0.5 + 2 * random.unit()), opacity = 0.3 + 0.6 * random.unit();
    const Vec4 rotation = rotationTo(random.direction(), random);
    addGaussian(scene, place, {radius, 0.8 * radius, 0.6 * radius}, rotation, opacity, DVec3(1));
    known.floaters.push_back(place);
    ++i;
  }
  for (std::size_t i = 0; i < extra(options.faint); ++i) {
    const DVec3 place = random.inBox(shape.center(), 1.3 * shape.size());
    const double radius = usual * (0.5 + 2 * random.unit());
    const Vec4 rotation = rotationTo(random.direction(), random);
    addGaussian(scene, place, DVec3(radius), rotation, 0.005 + 0.04 * random.unit(), DVec3(0));
  }
  for (std::size_t i = 0; i < options.huge; ++i) {
    const DVec3 place = random.inBox(shape.center(), 2 * shape.size());
    const Vec4 rotation = rotationTo(random.direction(), random);
    addGaussian(scene, place, DVec3(0.5 * shape.size()), rotation, 0.9, DVec3(1));
  }
  return known;
}

}  // namespace palpate::test
