// A wall in front of a depth camera that approaches and recedes, as a recording of 16 frames, and sessions with it on
// the CPU.
#pragma once

#include <doctest/doctest.h>

#include <cmath>

#include "haptics/session/interactive_session.hpp"
#include "tests/motion/depth_stream.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate {

inline constexpr DepthCamera kCamera{.width = 40, .height = 30, .fx = 100, .fy = 100, .cx = 19.5, .cy = 14.5};
inline constexpr double kRest_m = 0.5, kRate_Hz = 100, kDuration_s = 0.16, kHand_mm = 0.2;
inline constexpr double kRounded_mm = 0.02;  // resolution of the depths
inline constexpr int kFrames = 16;

/// Displacement of the wall towards the camera in a frame.
inline double nearer_mm(int frame) { return 1 - std::cos(2 * 3.14159265358979 * frame / kFrames); }

/// The displacement felt at that frame number: the surface moves from frame to frame, one behind.
inline double felt_mm(double place) {
  const int frame = std::min(kFrames - 1, static_cast<int>(std::floor(place + 1e-9)));
  if (frame == 0) return 0;
  return nearer_mm(frame - 1) + std::min(1.0, place - frame) * (nearer_mm(frame) - nearer_mm(frame - 1));
}

inline std::vector<float> wall(double depth_m) {
  return std::vector<float>(std::size_t{kCamera.width} * kCamera.height, static_cast<float>(depth_m));
}

/// A wall in front of a camera that stands at the origin; depths in fiftieths of a millimetre.
inline void writeWall(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "depth");
  for (int i = 0; i < kFrames; ++i)
    writeBytes(folder / "depth" / fmt::format("{:04}.png", i),
               depthPng(kCamera, wall(kRest_m - 1e-3 * nearer_mm(i)), 50'000));
  writeBytes(folder / "intrinsics.json", intrinsicsJson(kCamera, R"(, "depth_scale": 50000, "fps": 100)"));
}

inline SessionConfig playing(const std::filesystem::path& folder) {
  return {.model = {.file = folder.string(), .mm_per_unit = 1000, .stream = StreamConfig{}},
          .backend = {.name = "cpu"},
          .force = {.stiffness_N_per_mm = 0.5, .damping_N_s_per_mm = 0},
          .duration_s = kDuration_s};
}

/// Just in front of the wall's rest position.
inline Path atRest(double duration_s = kDuration_s) {
  const DVec3 hip(0, 0, kRest_m - 1e-3 * kHand_mm);
  return Path({{0, hip}, {duration_s, hip}});
}

inline Model load(const SessionConfig& config) {
  Log log(true);
  return loadModel(config.model, {.log = log, .threads = 1});
}

}  // namespace palpate
