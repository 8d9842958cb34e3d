// Depth frames of analytic shapes with the noise of a depth camera, and their true surface.
#pragma once

#include <glm/ext/quaternion_trigonometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <memory>
#include <vector>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/ray_cast.hpp"
#include "engine/core/depth_stream.hpp"
#include "engine/core/parallel.hpp"
#include "engine/motion/frame_fusion.hpp"

namespace palpate {

/// A quarter of a VGA camera's width, with the same pixel size.
inline DepthCamera smallCamera() { return {.width = 160, .height = 120, .fx = 525, .fy = 525, .cx = 79.5, .cy = 59.5}; }

/// Looks from `eye` at `target`, with z up in the picture.
inline CameraPose lookingAt(const DVec3& eye, const DVec3& target) {
  const DVec3 ahead = glm::normalize(target - eye);
  const DVec3 up = std::abs(ahead.z) > 0.99 ? DVec3(0, 1, 0) : DVec3(0, 0, 1);
  const DVec3 right = glm::normalize(glm::cross(ahead, up));
  const DVec3 down = glm::cross(ahead, right);
  return {.turn = glm::quat_cast(glm::dmat3(right, down, ahead)), .centre = eye};
}

/// On an arc about `target`, from above; `share` from 0 to 1.
inline CameraPose onArc(const DVec3& target, double distance, double share) {
  const double around = 1.2 * share - 0.6, above = 0.9 + 0.2 * share;
  return lookingAt(target + distance * DVec3(std::sin(around) * std::cos(above), -std::cos(around) * std::cos(above),
                                             std::sin(above)),
                   target);
}

inline double deviationAt(double depth_m) {
  const double beyond = std::max(depth_m - 0.4, 0.0);
  return 0.0012 + 0.0019 * beyond * beyond;
}

/// Objects in a room, in metres.
class DepthScene {
 public:
  DepthScene& add(std::string_view shape, double size, const DVec3& center) {
    shapes_.push_back(makeShape(shape, size, center));
    return *this;
  }

  /// Depth along z; 0 without a surface. `noise`: in standard deviations of the camera; one seed per frame.
  DepthFrame frame(const DepthCamera& camera, const CameraPose& pose, double noise = 0, std::uint64_t seed = 1) const {
    std::vector<TracedSurface> surfaces;
    for (const auto& shape : shapes_) surfaces.push_back(traced(*shape));
    DepthFrame frame{.number = seed, .pose = pose};
    frame.depth_m.resize(std::size_t{camera.width} * camera.height);
    parallelFor(frame.depth_m.size(), 0, [&](std::size_t begin, std::size_t end) {
      for (std::size_t pixel = begin; pixel < end; ++pixel) {
        const DVec3 ray =
            camera.placeAt(static_cast<double>(pixel % camera.width), static_cast<double>(pixel / camera.width), 1);
        double depth = std::numeric_limits<double>::infinity();
        for (const TracedSurface& surface : surfaces)
          if (const auto hit = castRay(surface, {.from = pose.centre, .along = pose.turn * ray}))
            depth = std::min(depth, hit->depth);
        if (!std::isfinite(depth)) continue;
        frame.depth_m[pixel] = static_cast<float>(depth + noise * deviationAt(depth) * randomNormal3(seed, pixel).x);
      }
    });
    return frame;
  }

  /// The nearest point on any surface.
  SurfacePoint closest(const DVec3& place) const {
    SurfacePoint nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& shape : shapes_) {
      const SurfacePoint on = shape->closest(place);
      if (const double distance = glm::distance(on.position, place); distance < least) {
        least = distance;
        nearest = on;
      }
    }
    return nearest;
  }

 private:
  std::vector<std::unique_ptr<AnalyticShape>> shapes_;
};

/// A sphere, a torus and a cube on a table.
inline DepthScene tableScene(const DVec3& at = DVec3(0)) {
  DepthScene scene;
  scene.add("plane", 0.8, at)
      .add("sphere", 0.08, at + DVec3(-0.06, 0, 0.04))
      .add("torus", 0.1, at + DVec3(0.06, 0.03, 0.02))
      .add("cube", 0.04, at + DVec3(0.02, -0.05, 0.02));
  return scene;
}

/// A stream owned by the test.
inline std::shared_ptr<DepthStream> unowned(DepthStream& stream) {
  return std::shared_ptr<DepthStream>(std::shared_ptr<void>(), &stream);
}

/// Options for tests: a small map and few threads.
inline FusionOptions smallMap(std::size_t capacity = 200'000) {
  FusionOptions options;
  options.capacity = capacity;
  options.threads = 2;
  return options;
}

/// Compares positions, normals and records bit by bit.
inline bool areSame(const shared::Surfel& a, const shared::Surfel& b) {
  return a.place == b.place && a.normal == b.normal && a.record.weight == b.record.weight &&
         a.record.seen == b.record.seen && a.record.counts == b.record.counts && a.record.color == b.record.color;
}
inline bool areSame(const SurfelMap& a, const SurfelMap& b) {
  if (a.ids() != b.ids()) return false;
  for (std::size_t id = 0; id < a.ids(); ++id)
    if (!areSame(a.surfel(id), b.surfel(id))) return false;
  return true;
}

}  // namespace palpate
