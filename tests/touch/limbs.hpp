// Models of several limbs that are close to each other, strokes on one of them, and what they change.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/brush.hpp"
#include "engine/core/point_state.hpp"
#include "tests/edit/surface_gaps.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate {

inline constexpr double kLimbSpacing = 0.8, kLimbSupport = 4 * kLimbSpacing, kLimbBrush = 6, kLimbTau = 0.5;

/// Samples of a model, even or, as the most uneven cloud, at random positions.
class Limbs {
 public:
  explicit Limbs(bool random) : isRandom_(random) {}

  /// A parallelogram with a normal.
  void addSheet(const DVec3& corner, const DVec3& u, const DVec3& v) {
    const DVec3 normal = glm::normalize(glm::cross(u, v));
    add(glm::length(u), glm::length(v), [&](double s, double t) { return std::pair(corner + s * u + t * v, normal); });
  }
  /// An open cylinder about `middle`, of this radius.
  void addRod(const DVec3& middle, const DVec3& axis, double radius, double length) {
    const DVec3 u = glm::normalize(glm::cross(axis, DVec3(0.31, 0.2, 1))), v = glm::cross(axis, u);
    add(2 * std::numbers::pi * radius, length, [&](double s, double t) {
      const double angle = 2 * std::numbers::pi * s;
      const DVec3 normal = std::cos(angle) * u + std::sin(angle) * v;
      return std::pair(middle + (t - 0.5) * length * axis + radius * normal, normal);
    });
  }
  /// A plate that faces up and down, with edges; its upper side in the middle at `top`.
  void addPlate(const DVec3& top, double side, double thick) {
    const DVec3 x(side, 0, 0), y(0, side, 0), z(0, 0, thick), corner = top - 0.5 * (x + y);
    addSheet(corner, x, y);
    addSheet(corner - z, y, x);
    addSheet(corner - z, x, z);
    addSheet(corner - z + y, z, x);
    addSheet(corner - z, z, y);
    addSheet(corner - z + x, y, z);
  }
  /// Removes what is inside a cylinder, of the points from `first` to `end`.
  void cut(std::size_t first, std::size_t end, const DVec3& middle, const DVec3& axis, double radius) {
    PointCloud left;
    for (std::size_t i = 0; i < size(); ++i) {
      const DVec3 offset = DVec3(cloud_.positions[i]) - middle;
      if (i >= first && i < end && glm::length(offset - glm::dot(offset, axis) * axis) < radius) continue;
      left.positions.push_back(cloud_.positions[i]);
      left.normals.push_back(cloud_.normals[i]);
    }
    cloud_ = left;
  }
  std::size_t size() const { return cloud_.size(); }
  const PointCloud& cloud() const { return cloud_; }

 private:
  template <class At>
  void add(double width, double height, At&& at) {
    const auto columns = std::max(1, static_cast<int>(std::round(width / kLimbSpacing)));
    const auto rows = std::max(1, static_cast<int>(std::round(height / kLimbSpacing)));
    std::uniform_real_distribution<double> share(0, 1);
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const auto [place, normal] = isRandom_ ? at(share(random_), share(random_))
                                               : at((i + 0.5 + 0.5 * (j % 2)) / (columns + 0.5), (j + 0.5) / rows);
        cloud_.positions.push_back(Vec3(place));
        cloud_.normals.push_back(Vec3(normal));
      }
  }

  bool isRandom_;
  std::mt19937 random_{5};
  PointCloud cloud_;
};

inline BrushOptions limbBrush(BrushKind kind) {
  return {.kind = kind, .yieldDepth = kLimbTau, .pushRate = 0.2, .radius = kLimbBrush, .strength = 0.5};
}

/// A place on a surface, and its outward direction there.
struct LimbPlace {
  DVec3 position, outward;
};

/// Presses: from a millimetre over each place to `depth` below, and, if there are more, along them.
inline std::vector<DVec3> pressed(const std::vector<LimbPlace>& places, double depth) {
  std::vector<DVec3> path{places.front().position + places.front().outward};
  for (const LimbPlace& place : places) path.push_back(place.position - depth * place.outward);
  return path;
}

/// The cloud after straight strokes from one position to the next, in so many ticks each, and a rest.
inline PointCloud stroked(TouchBackend& touch, const PointCloud& before, const std::vector<DVec3>& path,
                          double& time_s) {
  constexpr int kTicks = 60, kRest = 20;
  const auto go = [&](const DVec3& hip) { CHECK(touch.query({.time_s = time_s += 1e-3, .hip = hip}, 0).valid); };
  go(path.front());
  for (std::size_t leg = 1; leg < path.size(); ++leg)
    for (int k = 1; k <= kTicks; ++k) go(glm::mix(path[leg - 1], path[leg], double(k) / kTicks));
  for (int k = 0; k < kRest; ++k) go(path.back());
  touch.finish();
  PointCloud after = before;
  touch.readBack(after);
  return after;
}

inline PointCloud stroked(const OnBackEnd& backEnd, const Limbs& limbs, BrushKind kind,
                          const std::vector<DVec3>& path) {
  double time_s = 0;
  const auto touch = backEnd.make(limbs.cloud(), {.radius = kLimbSupport, .brush = limbBrush(kind)});
  return stroked(*touch, limbs.cloud(), path, time_s);
}

/// Of the points from `first` to `end`: those that are not exactly as they were.
inline std::size_t changedOf(const PointCloud& before, const PointCloud& after, std::size_t first, std::size_t end) {
  std::size_t changed = 0;
  for (std::size_t i = first; i < end; ++i)
    changed += i >= after.size() || after.positions[i] != before.positions[i] ||
               after.normals[i] != before.normals[i] || (after.hasColors() && after.colors[i] != kUnpainted);
  return changed;
}

/// Depth of the surface under a place, by the points around the line through it.
inline double depthUnder(const PointCloud& cloud, const LimbPlace& place) {
  double height = -1e9;
  for (const Vec3& position : cloud.positions) {
    const DVec3 offset = DVec3(position) - place.position;
    const double along = glm::dot(offset, place.outward);
    if (along > -9 && glm::length(offset - along * place.outward) < kLimbSpacing) height = std::max(height, along);
  }
  return -height;
}

inline DVec3 ballAt(const LimbPlace& place, double depth) {
  return place.position + (kLimbTau + kLimbBrush - depth) * place.outward;
}

/// Points of the first `count` inside the ball of a push at that depth.
inline std::size_t insideBall(const PointCloud& cloud, std::size_t count, const LimbPlace& place, double depth) {
  std::size_t inside = 0;
  for (std::size_t i = 0; i < count; ++i)
    inside += glm::distance(DVec3(cloud.positions[i]), ballAt(place, depth)) < kLimbBrush;
  return inside;
}

/// How deep in that ball the deepest point is.
inline double deepestInBall(const PointCloud& cloud, const LimbPlace& place, double depth) {
  double deepest = 0;
  for (const Vec3& position : cloud.positions)
    deepest = std::max(deepest, kLimbBrush - glm::distance(DVec3(position), ballAt(place, depth)));
  return deepest;
}

}  // namespace palpate
