#include "engine/motion/fusion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

// No short-circuit, so no branch.
bool isWithin(float depth, float least, float most) { return (depth >= least) & (depth <= most); }
bool isDepth(float depth) { return isWithin(depth, 0, std::numeric_limits<float>::max()); }

void requireWithin(std::string_view field, double value, double least, double most) {
  if (!(value >= least && value <= most)) throw Error("fusion: {} is {}, not {} to {}", field, value, least, most);
}

[[noreturn]] void refuseDepth(const DepthCamera& camera, const DepthFrame& frame) {
  const auto bad = std::ranges::find_if_not(frame.depth_m, isDepth);
  const auto pixel = static_cast<std::size_t>(bad - frame.depth_m.begin());
  throw Error("frame {}: the depth of pixel ({}, {}) is {}; expected a finite number from 0", frame.number,
              pixel % camera.width, pixel / camera.width, *bad);
}

// Latency matters: both loops can be vectorised by compilers.
void readDepths(const DepthCamera& camera, const DepthFrame& frame, const FusionOptions& options,
                std::vector<float>& depths) {
  depths.resize(frame.depth_m.size());
  const auto nearest = static_cast<float>(options.nearest_m), farthest = static_cast<float>(options.farthest_m);
  std::uint32_t bad = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const float depth = frame.depth_m[i];
    bad |= isDepth(depth) ? 0u : 1u;
    depths[i] = isWithin(depth, nearest, farthest) ? depth : 0.0f;
  }
  if (bad) refuseDepth(camera, frame);
}

void readColors(const DepthFrame& frame, std::vector<std::uint32_t>& colors) {
  colors.resize(frame.colors.size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const std::uint32_t red = frame.colors[i][0], green = frame.colors[i][1], blue = frame.colors[i][2];
    colors[i] = red | green << 8 | blue << 16 | 0xff000000u;
  }
}

}  // namespace

void FusionOptions::validate() const {
  requireWithin("capacity", static_cast<double>(capacity), 1, std::numeric_limits<std::int32_t>::max());
  requireWithin("nearest_m", nearest_m, 1e-3, 100);
  requireWithin("farthest_m", farthest_m, nearest_m, 1000);
  requireWithin("memory_frames", memory_frames, 1, 10'000);
  requireWithin("noiseLeast_m", noiseLeast_m, 1e-6, 1);
  requireWithin("noiseGrowth_per_m", noiseGrowth_per_m, 0, 1);
  requireWithin("noiseFrom_m", noiseFrom_m, 0, 100);
}

void requireCamera(const DepthCamera& camera) {
  if (camera.width == 0 || camera.height == 0 || std::uint64_t{camera.width} * camera.height > (1u << 28))
    throw Error("a depth camera of {} x {} pixels; expected 1 to 2^28 pixels", camera.width, camera.height);
  if (!isFinite(DVec4(camera.fx, camera.fy, camera.cx, camera.cy)) || !(camera.fx > 0) || !(camera.fy > 0))
    throw Error("a depth camera with fx {}, fy {}, cx {}, cy {}; expected finite numbers, and positive focal lengths",
                camera.fx, camera.fy, camera.cx, camera.cy);
}

void readFrame(const DepthCamera& camera, const DepthFrame& frame, const FusionOptions& options, FrameImages& images) {
  requireCamera(camera);
  const std::size_t pixels = std::size_t{camera.width} * camera.height;
  if (frame.depth_m.size() != pixels)
    throw Error("frame {} has {} depths, and its camera {} pixels", frame.number, frame.depth_m.size(), pixels);
  if (!frame.colors.empty() && frame.colors.size() != pixels)
    throw Error("frame {} has {} colours, and its camera {} pixels", frame.number, frame.colors.size(), pixels);
  images.camera = camera;
  images.number = frame.number;
  readDepths(camera, frame, options, images.depths);
  readColors(frame, images.colors);
}

shared::SurfelRecord givenRecord(const FusionOptions& options, std::uint32_t color) {
  const float deviation = shared::depthDeviation(sensorOf({}, options).noise, 1.0f);
  return {.weight = static_cast<float>(shared::kStableCount) / (deviation * deviation),
          .seen = 0,
          .counts = shared::kStableCount,
          .color = color == 0 ? 0u : color | 0xff000000u};
}

shared::DepthSensor sensorOf(const DepthCamera& camera, const FusionOptions& options) {
  return {.camera = {.fx = static_cast<float>(camera.fx),
                     .fy = static_cast<float>(camera.fy),
                     .cx = static_cast<float>(camera.cx),
                     .cy = static_cast<float>(camera.cy)},
          .noise = {.least = static_cast<float>(options.noiseLeast_m),
                    .growth = static_cast<float>(options.noiseGrowth_per_m),
                    .from = static_cast<float>(options.noiseFrom_m)}};
}

void requirePose(const CameraPose& pose, std::uint64_t frame) {
  const double length = glm::length(pose.turn);
  if (!isFinite(pose.centre) || !(std::abs(length - 1) < 1e-3))
    throw Error("frame {}: its pose is not a rotation and position: a quaternion of length {} at ({}, {}, {})", frame,
                length, pose.centre.x, pose.centre.y, pose.centre.z);
}

shared::FusionView fusionView(const FrameImages& images, const CameraPose& pose, const DVec3& origin,
                              const FusionOptions& options) {
  requirePose(pose, images.number);
  const DQuat turn = glm::normalize(pose.turn);
  return {.right = Vec3(turn * DVec3(1, 0, 0)),
          .down = Vec3(turn * DVec3(0, 1, 0)),
          .ahead = Vec3(turn * DVec3(0, 0, 1)),
          .centre = Vec3(pose.centre - origin),
          .sensor = sensorOf(images.camera, options),
          .memory = static_cast<float>(options.memory_frames),
          .width = images.camera.width,
          .height = images.camera.height,
          .number = static_cast<std::uint32_t>(images.number),
          .colored = images.colors.empty() ? 0u : 1u,
          .felt = 0,
          .left = 0,
          .perSecond = 0};
}

std::array<std::uint8_t, 3> colorOf(const shared::SurfelRecord& record) {
  const std::uint32_t c = record.color >> 24 ? record.color : shared::kUnseenColor;
  const auto channel = [c](int shift) { return static_cast<std::uint8_t>(c >> shift & 0xffu); };
  return {channel(0), channel(8), channel(16)};
}

DVec3 mapOriginFor(const CameraPose& pose) {
  constexpr double kNearZero_m = 16;
  const DVec3 c = pose.centre;
  if (glm::length(c) < kNearZero_m) return DVec3(0);
  return {std::round(c.x), std::round(c.y), std::round(c.z)};
}

void findPixelSurfaces(const FrameImages& images, const FusionOptions& options,
                       std::vector<shared::PixelSurface>& surfaces) {
  const shared::DepthSensor sensor = sensorOf(images.camera, options);
  surfaces.resize(images.depths.size());
  parallelFor(surfaces.size(), options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin; pixel < end; ++pixel)
      surfaces[pixel] = pixelSurface(images, sensor, static_cast<int>(pixel % images.camera.width),
                                     static_cast<int>(pixel / images.camera.width));
  });
}

}  // namespace palpate
