#include "engine/motion/depth_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kSteepest = 10;     // tangent of the angle at which a surface is seen that is worth a normal
constexpr double kLeastJump = 0.01;  // of the depth: what a structured-light camera rounds to at four metres
constexpr double kFarthest_m = 1e5;

/// What the pixels of a frame see, in the camera's axes.
class DepthGrid {
 public:
  DepthGrid(const DepthCamera& camera, const DepthFrame& frame)
      : width_(camera.width),
        height_(camera.height),
        jump_(std::max(kLeastJump, kSteepest / std::min(camera.fx, camera.fy))) {
    places_.reserve(frame.depth_m.size());
    for (std::uint32_t row = 0; row < height_; ++row)
      for (std::uint32_t column = 0; column < width_; ++column) {
        const double depth = frame.depth_m[places_.size()];
        places_.push_back(camera.placeAt(column, row, depth > 0 && depth <= kFarthest_m ? depth : 0));
      }
  }

  bool isMeasured(std::size_t pixel) const { return places_[pixel].z > 0; }
  const DVec3& placeAt(std::size_t pixel) const { return places_[pixel]; }
  /// Unit, towards the camera; nothing where nobody knows.
  std::optional<DVec3> normalAt(std::uint32_t column, std::uint32_t row) const {
    const std::size_t pixel = std::size_t{row} * width_ + column;
    const auto across = wayAlong(pixel, 1, column > 0, column + 1 < width_);
    const auto down = wayAlong(pixel, width_, row > 0, row + 1 < height_);
    if (!across || !down) return std::nullopt;
    const DVec3 normal = glm::cross(*down, *across);
    const double size = glm::length(normal);
    if (!(size > 0)) return std::nullopt;
    return normal / (glm::dot(normal, places_[pixel]) > 0 ? -size : size);
  }

 private:
  bool isSameSurface(std::size_t pixel, std::size_t other) const {
    const double depth = places_[pixel].z, there = places_[other].z;
    return there > 0 && std::abs(there - depth) <= jump_ * depth;
  }
  /// From the pixel before to the one behind, `stride` pixels from this one, where the picture has them.
  std::optional<DVec3> wayAlong(std::size_t pixel, std::size_t stride, bool hasBefore, bool hasBehind) const {
    const bool before = hasBefore && isSameSurface(pixel, pixel - stride);
    const bool behind = hasBehind && isSameSurface(pixel, pixel + stride);
    if (!before && !behind) return std::nullopt;
    return places_[behind ? pixel + stride : pixel] - places_[before ? pixel - stride : pixel];
  }

  std::uint32_t width_, height_;
  double jump_;                // of depth from pixel to pixel, in depths
  std::vector<DVec3> places_;  // depth 0 where none was measured
};

void requireWhole(const DepthCamera& camera, const DepthFrame& frame) {
  const std::size_t pixels = std::size_t{camera.width} * camera.height;
  if (frame.depth_m.size() != pixels || (!frame.colors.empty() && frame.colors.size() != pixels))
    throw Error("frame {} has {} depths and {} colours, and the camera {} x {} pixels", frame.number,
                frame.depth_m.size(), frame.colors.size(), camera.width, camera.height);
}

}  // namespace

void makePoints(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin, CloudFrame& points,
                std::vector<std::uint32_t>* pixels) {
  requireWhole(camera, frame);
  points.positions.clear();
  points.normals.clear();
  points.velocities.clear();
  points.colors.clear();
  points.ids.clear();
  if (pixels) pixels->clear();
  const DepthGrid grid(camera, frame);
  const CameraPose pose = frame.pose.value_or(CameraPose{});
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      const std::size_t pixel = std::size_t{row} * camera.width + column;
      if (!grid.isMeasured(pixel)) continue;
      const auto normal = grid.normalAt(column, row);
      const Vec3 place(pose.toWorld(grid.placeAt(pixel)) - origin);
      if (!normal || !isFinite(place)) continue;
      points.positions.push_back(place);
      points.normals.push_back(Vec3(pose.turn * *normal));
      if (pixels) pixels->push_back(static_cast<std::uint32_t>(pixel));
      if (!frame.colors.empty()) points.colors.push_back(frame.colors[pixel]);
    }
}

}  // namespace palpate
