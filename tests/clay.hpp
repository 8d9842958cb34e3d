// Strokes over analytic shapes, and their results compared with analytic truth.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/touch/touch_backend.hpp"
#include "tests/scenes.hpp"

namespace palpate {

inline constexpr double kClayTau = 0.5, kClayRadius = 6;

inline BrushOptions clayBrush(BrushKind kind) {
  return {.kind = kind, .yieldDepth = kClayTau, .pushRate = 0.1, .radius = kClayRadius, .strength = 0.5};
}

/// Positions of a hand, tick by tick, and the surface along its path.
struct ClayGesture {
  std::vector<DVec3> hips;
  std::vector<SurfacePoint> way;  // surface along the path
  double depth = 0;
};

/// Down into the top of a shape, along it for 24 units, and up again.
inline ClayGesture clayDrag(const Scene& scene, double depth, double speed) {
  ClayGesture gesture{.depth = depth};
  const auto over = [&](double x, double height) {
    const SurfacePoint on = scene.shape->closest({x, 0.3, 1000});
    return on.position + height * on.normal;
  };
  const auto go = [&](auto&& place, double length) {
    const int ticks = std::max(1, static_cast<int>(std::ceil(length / (speed * 1e-3))));
    for (int k = 1; k <= ticks; ++k) gesture.hips.push_back(place(double(k) / ticks));
  };
  go([&](double s) { return over(-12, 3 - s * (3 + depth)); }, 3 + depth);
  go([&](double s) { return over(-12 + 24 * s, -depth); }, 24);
  go([&](double s) { return over(12, -depth + s * (depth + 4)); }, depth + 4);
  for (int k = 0; k < 100; ++k) gesture.hips.push_back(gesture.hips.back());
  for (double x = -12; x <= 12; x += 0.5) gesture.way.push_back(scene.shape->closest({x, 0.3, 1000}));
  return gesture;
}

struct ClayResult {
  PointCloud cloud;
  double deepest = 0, highest = 0;           // largest distance under and over the shape
  double trenchLeast = 1e9, trenchMost = 0;  // depth of the trench's middle along the path, without its ends
  std::size_t added = 0, changed = 0;
  double secondLayer = 0;  // fraction of the changed points with one that faces the other way within half a spacing
};

inline ClayResult judgeClay(const Scene& scene, const ClayGesture& gesture, PointCloud after) {
  ClayResult result{.cloud = std::move(after)};
  const auto height = [&](const DVec3& place) {
    const SurfacePoint on = scene.shape->closest(place);
    return glm::dot(place - on.position, on.normal);
  };
  const PointTree before(scene.cloud.positions), tree(result.cloud.positions);
  result.added = result.cloud.size() - std::min(result.cloud.size(), scene.cloud.size());
  std::vector<std::uint32_t> near;
  std::size_t second = 0;
  for (std::size_t i = 0; i < result.cloud.size(); ++i) {
    const DVec3 place(result.cloud.positions[i]);
    near.clear();
    before.near(place, 1e-4, near);
    if (!near.empty()) continue;
    ++result.changed;
    result.deepest = std::max(result.deepest, -height(place));
    result.highest = std::max(result.highest, height(place));
    near.clear();
    tree.near(place, 0.5 * scene.spacing, near);
    second += std::ranges::any_of(near, [&](std::uint32_t k) {
      return glm::dot(DVec3(result.cloud.normals[k]), DVec3(result.cloud.normals[i])) < -0.3;
    });
  }
  result.secondLayer = result.changed > 0 ? static_cast<double>(second) / static_cast<double>(result.changed) : 0;
  for (std::size_t k = 4; k + 4 < gesture.way.size(); ++k) {
    const SurfacePoint& on = gesture.way[k];
    double deepest = -1e9;
    for (double down = -3; down < gesture.depth + 3; down += 0.5 * scene.spacing) {
      near.clear();
      tree.near(on.position - down * on.normal, 1.2 * scene.spacing, near);
      for (const std::uint32_t i : near)
        deepest = std::max(deepest, -glm::dot(DVec3(result.cloud.positions[i]) - on.position, on.normal));
    }
    result.trenchLeast = std::min(result.trenchLeast, deepest);
    result.trenchMost = std::max(result.trenchMost, deepest);
  }
  return result;
}

/// Depth within a quarter and 0.4 mm of the hand's, no points over the surface, no second layer.
inline void checkClay(const ClayResult& result, double depth) {
  const double tip = depth - kClayTau, slack = 0.25 * tip + 0.4;
  CHECK(result.changed > 10);
  CHECK(std::abs(result.deepest - tip) <= slack);
  CHECK(std::abs(result.trenchLeast - tip) <= slack);
  CHECK(std::abs(result.trenchMost - tip) <= slack);
  CHECK(result.highest <= 0.3);
  CHECK(result.secondLayer <= 0.01);
}

/// Plays the gesture on a machine that completes one tick of `every`.
inline ClayResult mould(TouchBackend& touch, const Scene& scene, const ClayGesture& gesture, int every = 1) {
  for (std::size_t k = 0; k < gesture.hips.size(); k += static_cast<std::size_t>(every))
    CHECK(touch.query({.time_s = 1e-3 * static_cast<double>(k), .hip = gesture.hips[k]}, 0).valid);
  touch.finish();
  PointCloud after = scene.cloud;
  touch.readBack(after);
  return judgeClay(scene, gesture, std::move(after));
}

}  // namespace palpate
