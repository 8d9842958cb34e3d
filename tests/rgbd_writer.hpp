// Folders of depth images of a scene, in the layouts of the TUM benchmark and Redwood.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <glm/gtc/quaternion.hpp>

#include "engine/cloud/ray_cast.hpp"
#include "engine/core/depth_stream.hpp"
#include "tests/png_bytes.hpp"

namespace palpate {

/// A sphere of a metre, two metres away, in front of a camera that moves right and rotates left.
inline const AnalyticShape& recordedShape() {
  static const auto shape = makeShape("sphere", 1.0, DVec3(0.1, 0, 2));
  return *shape;
}
inline CameraPose recordedPose(double time_s) {
  const double half = 0.05 * time_s;
  return {.turn = {std::cos(half), 0, -std::sin(half), 0}, .centre = {0.2 * time_s, 0.01, 0}};
}
inline DepthCamera recordedCamera() { return {.width = 24, .height = 18, .fx = 20, .fy = 21, .cx = 11.5, .cy = 8.5}; }

/// Depth along z, metres; 0 beside the shape.
inline std::vector<float> depthSeen(const DepthCamera& camera, const CameraPose& pose,
                                    const AnalyticShape& shape = recordedShape()) {
  const TracedSurface surface = traced(shape);
  std::vector<float> depth_m;
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      const auto hit = castRay(surface, {.from = pose.centre, .along = pose.turn * camera.placeAt(column, row, 1)});
      depth_m.push_back(hit ? static_cast<float>(hit->depth) : 0);
    }
  return depth_m;
}

inline std::string depthPng(const DepthCamera& camera, std::span<const float> depth_m, double scale) {
  std::vector<std::uint16_t> values;
  for (const float depth : depth_m) values.push_back(static_cast<std::uint16_t>(std::lround(depth * scale)));
  return greyPng(camera.width, camera.height, values);
}

/// Each pixel's red, green and blue are its column, its row and the frame's number.
inline std::string colorPng(std::uint32_t width, std::uint32_t height, int number) {
  std::string rows;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      rows += std::string{static_cast<char>(x), static_cast<char>(y), static_cast<char>(number)};
  return pngBytes(width, height, 8, 2, rows);
}

inline std::string intrinsicsJson(const DepthCamera& camera, const std::string& more = "") {
  return fmt::format(R"({{"width": {}, "height": {}, "fx": {}, "fy": {}, "cx": {}, "cy": {}{}}})", camera.width,
                     camera.height, camera.fx, camera.fy, camera.cx, camera.cy, more);
}

/// Rows of the camera-to-world matrix.
inline std::array<double, 16> rowsOf(const CameraPose& pose) {
  const glm::dmat3 turn = glm::mat3_cast(pose.turn);
  const DVec3& c = pose.centre;
  return {turn[0][0], turn[1][0], turn[2][0], c.x, turn[0][1], turn[1][1], turn[2][1], c.y,
          turn[0][2], turn[1][2], turn[2][2], c.z, 0,          0,          0,          1};
}

struct RecordingPlan {
  int frames = 4;
  double rate_Hz = 30;  ///< 30 is assumed for a Redwood folder
};

/// Redwood's layout: frames 0, 1, 2, … in depth and color, millimetres, trajectory.log and intrinsics.json.
inline void writeRedwood(const std::filesystem::path& folder, const RecordingPlan& plan = {}) {
  for (const char* name : {"depth", "color"}) std::filesystem::create_directories(folder / name);
  const DepthCamera camera = recordedCamera();
  std::string log;
  for (int i = 0; i < plan.frames; ++i) {
    const CameraPose pose = recordedPose(i / plan.rate_Hz);
    writeBytes(folder / "depth" / fmt::format("{:05}.png", i), depthPng(camera, depthSeen(camera, pose), 1000));
    writeBytes(folder / "color" / fmt::format("{:05}.png", i), colorPng(camera.width, camera.height, i));
    log += fmt::format("{} {} {}\n", i, i, i + 1);
    const auto rows = rowsOf(pose);
    for (std::size_t row = 0; row < 4; ++row)
      log += fmt::format("{:.8f} {:.8f} {:.8f} {:.8f}\n", rows[4 * row], rows[4 * row + 1], rows[4 * row + 2],
                         rows[4 * row + 3]);
  }
  writeBytes(folder / "trajectory.log", log);
  writeBytes(folder / "intrinsics.json", intrinsicsJson(camera));
}

/// TUM's layout: stamps far from 0, colours slightly late, poses at other times, 5000 units per metre; with
/// intrinsics.json.
inline void writeTum(const std::filesystem::path& folder, const RecordingPlan& plan = {}) {
  for (const char* name : {"depth", "rgb"}) std::filesystem::create_directories(folder / name);
  const DepthCamera camera = recordedCamera();
  constexpr double kBegin_s = 1305031102.175304;
  std::string depths = "# depth maps\n", colors = "# color images\n# timestamp filename\n", poses = "# ground truth\n";
  for (int i = 0; i < plan.frames; ++i) {
    const double time_s = i / plan.rate_Hz;
    const std::string name = fmt::format("{:.6f}.png", kBegin_s + time_s);
    writeBytes(folder / "depth" / name, depthPng(camera, depthSeen(camera, recordedPose(time_s)), 5000));
    writeBytes(folder / "rgb" / name, colorPng(camera.width, camera.height, i));
    depths += fmt::format("{:.6f} depth/{}\n", kBegin_s + time_s, name);
    colors += fmt::format("{:.6f} rgb/{}\n", kBegin_s + time_s + 0.011, name);
  }
  for (double time_s = -0.013; time_s < plan.frames / plan.rate_Hz + 0.02; time_s += 0.01) {
    const CameraPose pose = recordedPose(time_s);
    poses += fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", kBegin_s + time_s, pose.centre.x,
                         pose.centre.y, pose.centre.z, pose.turn.x, pose.turn.y, pose.turn.z, pose.turn.w);
  }
  writeBytes(folder / "depth.txt", depths);
  writeBytes(folder / "rgb.txt", colors);
  writeBytes(folder / "groundtruth.txt", poses);
  writeBytes(folder / "intrinsics.json", intrinsicsJson(camera));
}

}  // namespace palpate
