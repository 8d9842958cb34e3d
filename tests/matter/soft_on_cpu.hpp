// A soft body under a hand on the CPU.
#pragma once

#include <algorithm>
#include <memory>

#include "engine/touch/cpu_touch.hpp"
#include "tests/matter/soft_scene.hpp"

namespace palpate {

inline std::unique_ptr<TouchBackend> feltOnCpu(const PointCloud& cloud, CloudSource& source, double radius,
                                               const SoftTouchOptions& touch) {
  return std::make_unique<CpuTouch>(
      cloud, CpuTouchOptions{
                 .radius = radius, .friction = touch.friction, .tools = touch.tools, .threads = 1, .source = &source});
}

inline SoftScene touched(const MatterScene& scene, const SoftTouching& options = {}) {
  return {scene, options, feltOnCpu};
}

// Above the centre of the block, at this depth.
inline DVec3 atDepth(double depth) { return {50, 40 - depth, 50}; }

// From 2 mm above down to `depth` within `down_s`, then at rest.
inline Pose press(double time_s, double depth, double down_s = 0.3) {
  return {.time_s = time_s, .hip = atDepth(-2 + (depth + 2) * std::min(time_s / down_s, 1.0))};
}

}  // namespace palpate
