#include "engine/motion/depth_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

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
      : camera_(camera),
        depth_m_(frame.depth_m),
        jump_(std::max(kLeastJump, kSteepest / std::min(camera.fx, camera.fy))) {}

  double depthAt(std::int64_t column, std::int64_t row) const {
    if (column < 0 || row < 0 || column >= camera_.width || row >= camera_.height) return 0;
    const double depth = depth_m_[static_cast<std::size_t>(row * camera_.width + column)];
    return depth > 0 && depth <= kFarthest_m ? depth : 0;
  }
  DVec3 placeAt(std::int64_t column, std::int64_t row) const {
    return camera_.placeAt(static_cast<double>(column), static_cast<double>(row), depthAt(column, row));
  }
  /// Unit, towards the camera; nothing where nobody knows.
  std::optional<DVec3> normalAt(std::int64_t column, std::int64_t row) const {
    const auto across = wayAlong(column, row, 1, 0), down = wayAlong(column, row, 0, 1);
    if (!across || !down) return std::nullopt;
    const DVec3 normal = glm::cross(*down, *across);
    const double size = glm::length(normal);
    if (!(size > 0)) return std::nullopt;
    return normal / (glm::dot(normal, placeAt(column, row)) > 0 ? -size : size);
  }

 private:
  bool isSameSurface(double depth, double other) const { return other > 0 && std::abs(other - depth) <= jump_ * depth; }
  /// From the pixel before to the one behind.
  std::optional<DVec3> wayAlong(std::int64_t column, std::int64_t row, std::int64_t right, std::int64_t down) const {
    const double depth = depthAt(column, row);
    const bool before = isSameSurface(depth, depthAt(column - right, row - down));
    const bool behind = isSameSurface(depth, depthAt(column + right, row + down));
    if (!before && !behind) return std::nullopt;
    const DVec3 from = before ? placeAt(column - right, row - down) : placeAt(column, row);
    const DVec3 to = behind ? placeAt(column + right, row + down) : placeAt(column, row);
    return to - from;
  }

  const DepthCamera& camera_;
  const std::vector<float>& depth_m_;
  double jump_;  // of depth from pixel to pixel, in depths
};

void requireWhole(const DepthCamera& camera, const DepthFrame& frame) {
  const std::size_t pixels = std::size_t{camera.width} * camera.height;
  if (frame.depth_m.size() != pixels || (!frame.colors.empty() && frame.colors.size() != pixels))
    throw Error("frame {} has {} depths and {} colours, and the camera {} x {} pixels", frame.number,
                frame.depth_m.size(), frame.colors.size(), camera.width, camera.height);
}

}  // namespace

void makePoints(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin, CloudFrame& points) {
  requireWhole(camera, frame);
  points.positions.clear();
  points.normals.clear();
  points.velocities.clear();
  points.colors.clear();
  points.ids.clear();
  const DepthGrid grid(camera, frame);
  const CameraPose pose = frame.pose.value_or(CameraPose{});
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      if (grid.depthAt(column, row) == 0) continue;
      const auto normal = grid.normalAt(column, row);
      const Vec3 place(pose.toWorld(grid.placeAt(column, row)) - origin);
      if (!normal || !isFinite(place)) continue;
      points.positions.push_back(place);
      points.normals.push_back(Vec3(pose.turn * *normal));
      if (!frame.colors.empty()) points.colors.push_back(frame.colors[std::size_t{row} * camera.width + column]);
    }
}

}  // namespace palpate
