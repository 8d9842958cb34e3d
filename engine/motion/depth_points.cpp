#include "engine/motion/depth_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/motion/fusion.hpp"

namespace palpate {

namespace {

constexpr double kSteepest = 10;   // tangent of the largest angle of view at which normals are computed
constexpr double kMinJump = 0.01;  // in depths: rounding step of a structured-light camera at four metres
constexpr double kFarthest_m = 1e5;

/// Positions and normals of a frame's pixels, in the camera's axes.
class DepthGrid {
 public:
  DepthGrid(const DepthCamera& camera, const DepthFrame& frame)
      : depths_(frame.depth_m),
        width_(camera.width),
        height_(camera.height),
        sensor_(sensorOf(camera, {})),
        jump_(std::max(kMinJump, kSteepest / std::min(camera.fx, camera.fy))) {
    for (std::uint32_t column = 0; column < width_; ++column) across_.push_back(camera.placeAt(column, 0, 1).x);
    for (std::uint32_t row = 0; row < height_; ++row) down_.push_back(camera.placeAt(0, row, 1).y);
  }

  /// 0 if not measured.
  double depthAt(std::size_t pixel) const {
    const double depth = depths_[pixel];
    return depth > 0 && depth <= kFarthest_m ? depth : 0;
  }
  DVec3 placeAt(std::uint32_t column, std::uint32_t row) const {
    const double depth = depthAt(pixelAt(column, row));
    return {across_[column] * depth, down_[row] * depth, depth};
  }
  /// Unit normal towards the camera of a pixel that sees `place`; nothing if it cannot be computed.
  std::optional<DVec3> normalAt(std::uint32_t column, std::uint32_t row, const DVec3& place) const {
    for (int reach = shared::fitReach(sensor_, static_cast<float>(place.z)); reach > 1; --reach)
      if (const auto normal = wideNormal(column, row, place, static_cast<std::uint32_t>(reach))) return normal;
    const auto across = way(place, {column, row, column > 0, column + 1 < width_}, {1, 0});
    const auto down = way(place, {column, row, row > 0, row + 1 < height_}, {0, 1});
    if (!across || !down) return std::nullopt;
    return upright(*across, *down, place);
  }

 private:
  /// Normal of the plane fitted to the pixel and its eight neighbours at distance `reach`; nothing if they do not all
  /// see its surface.
  std::optional<DVec3> wideNormal(std::uint32_t column, std::uint32_t row, const DVec3& place,
                                  std::uint32_t reach) const {
    if (column < reach || row < reach || column + reach >= width_ || row + reach >= height_) return std::nullopt;
    DVec3 across(0), down(0);
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        if (x == 0 && y == 0) continue;
        const std::uint32_t there = column + x * reach, below = row + y * reach;
        if (!isSameSurface(place.z, depthAt(pixelAt(there, below)))) return std::nullopt;
        const DVec3 seen = placeAt(there, below);
        across += static_cast<double>(x) * seen;
        down += static_cast<double>(y) * seen;
      }
    return upright(across, down, place);
  }
  static std::optional<DVec3> upright(const DVec3& across, const DVec3& down, const DVec3& place) {
    const DVec3 normal = glm::cross(down, across);
    const double size = glm::length(normal);
    if (!(size > 0)) return std::nullopt;
    return normal * (glm::dot(normal, place) > 0 ? -1 / size : 1 / size);
  }
  struct Pixel {
    std::uint32_t column, row;
    bool hasBefore, hasBehind;  // whether the image has the neighbours in the direction of the step
  };
  struct Step {
    std::uint32_t columns, rows;
  };
  std::size_t pixelAt(std::uint32_t column, std::uint32_t row) const { return std::size_t{row} * width_ + column; }
  bool isSameSurface(double depth, double there) const { return there > 0 && std::abs(there - depth) <= jump_ * depth; }
  /// Difference from the previous pixel to the next, as far as they exist and see the same surface.
  std::optional<DVec3> way(const DVec3& place, const Pixel& at, const Step& step) const {
    const std::size_t pixel = pixelAt(at.column, at.row), stride = pixelAt(step.columns, step.rows);
    const bool before = at.hasBefore && isSameSurface(place.z, depthAt(pixel - stride));
    const bool behind = at.hasBehind && isSameSurface(place.z, depthAt(pixel + stride));
    if (!before && !behind) return std::nullopt;
    return (behind ? placeAt(at.column + step.columns, at.row + step.rows) : place) -
           (before ? placeAt(at.column - step.columns, at.row - step.rows) : place);
  }

  const std::vector<float>& depths_;
  std::uint32_t width_, height_;
  shared::DepthSensor sensor_;         // its noise determines how wide a normal's fit is
  double jump_;                        // largest depth difference from pixel to pixel, in depths
  std::vector<double> across_, down_;  // of a position at depth 1, by column and by row
};

void requireWhole(const DepthCamera& camera, const DepthFrame& frame) {
  const std::size_t pixels = std::size_t{camera.width} * camera.height;
  if (frame.points) {
    const std::size_t points = frame.points->places.size(), colors = frame.colors.size();
    if (points > pixels) throw Error("frame {} has {} points; the maximum is {}", frame.number, points, pixels);
    if (frame.points->normals.size() != points || (colors != 0 && colors != points))
      throw Error("frame {} has {} points, {} normals and {} colours", frame.number, points,
                  frame.points->normals.size(), colors);
    const std::vector<std::uint32_t>& rays = frame.points->rays;
    if (!rays.empty() && (rays.size() != points || rays.back() >= pixels))
      throw Error("frame {} has {} points on {} rays; the sensor has {}", frame.number, points, rays.size(), pixels);
    return;
  }
  if (frame.depth_m.size() != pixels || (!frame.colors.empty() && frame.colors.size() != pixels))
    throw Error("frame {} has {} depths and {} colours, and the camera {} x {} pixels", frame.number,
                frame.depth_m.size(), frame.colors.size(), camera.width, camera.height);
}

}  // namespace

void DepthPoints::make(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin, CloudFrame& points) {
  requireWhole(camera, frame);
  points.positions.clear(), points.normals.clear(), points.velocities.clear(), points.turns.clear();
  points.slides = true;
  points.colors.clear(), points.ids.clear(), pixels_.clear();
  if (frame.points) return makeFromPoints(frame, origin, points);
  makeFromDepths(camera, frame, origin, points);
  if (frame.colors.empty()) return;
  points.colors.resize(pixels_.size());
  for (std::size_t i = 0; i < pixels_.size(); ++i) points.colors[i] = frame.colors[pixels_[i]];
}

void DepthPoints::normalsByPixel(const CloudFrame& points, std::size_t pixels, std::vector<Vec3>& normals) const {
  normals.assign(pixels, Vec3(0));
  for (std::size_t i = 0; i < pixels_.size(); ++i) normals[pixels_[i]] = points.normals[i];
}

void DepthPoints::makeFromPoints(const DepthFrame& frame, const DVec3& origin, CloudFrame& points) {
  const SensedPoints& sensed = *frame.points;
  const CameraAxes axes(frame.pose.value_or(CameraPose{}));
  for (std::uint32_t i = 0; i < sensed.places.size(); ++i) {
    const Vec3 place(axes.toWorld(sensed.places[i]) - origin);
    if (!isFinite(place)) continue;
    points.positions.push_back(place);
    points.normals.push_back(Vec3(axes.turned(DVec3(sensed.normals[i]))));
    if (!frame.colors.empty()) points.colors.push_back(frame.colors[i]);
    pixels_.push_back(sensed.rays.empty() ? i : sensed.rays[i]);
  }
}

void DepthPoints::makeFromDepths(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin,
                                 CloudFrame& points) {
  const DepthGrid grid(camera, frame);
  const CameraAxes axes(frame.pose.value_or(CameraPose{}));
  const auto makeRow = [&](std::uint32_t row, Part& part) {
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      const DVec3 seen = grid.placeAt(column, row);
      if (!(seen.z > 0)) continue;
      const auto normal = grid.normalAt(column, row, seen);
      if (!normal) continue;
      const Vec3 place(axes.toWorld(seen) - origin);
      if (!isFinite(place)) continue;
      part.positions.push_back(place);
      part.normals.push_back(Vec3(axes.turned(*normal)));
      part.pixels.push_back(row * camera.width + column);
    }
  };
  parts_.resize(std::min(threadCount(threads_), std::max(1u, camera.height)));
  parallelParts(parts_.size(), [&](std::size_t i) {
    Part& part = parts_[i];
    part.positions.clear(), part.normals.clear(), part.pixels.clear();
    const auto firstRow = [&](std::size_t k) { return static_cast<std::uint32_t>(camera.height * k / parts_.size()); };
    for (std::uint32_t row = firstRow(i); row < firstRow(i + 1); ++row) makeRow(row, part);
  });
  for (const Part& part : parts_) append(part, points);
}

void DepthPoints::append(const Part& part, CloudFrame& points) {
  points.positions.insert(points.positions.end(), part.positions.begin(), part.positions.end());
  points.normals.insert(points.normals.end(), part.normals.begin(), part.normals.end());
  pixels_.insert(pixels_.end(), part.pixels.begin(), part.pixels.end());
}

}  // namespace palpate
