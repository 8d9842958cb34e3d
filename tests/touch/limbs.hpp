// Strokes on one of several limbs that are close to each other: the others stay as they are, bit by bit. For each back
// end.
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/brush.hpp"
#include "engine/core/point_state.hpp"
#include "engine/touch/touch_backend.hpp"
#include "tests/edit/surface_gaps.hpp"
#include "tests/near.hpp"

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

using MakeLimbTouch =
    std::function<std::unique_ptr<TouchBackend>(const PointCloud& cloud, double radius, const BrushOptions& brush)>;

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

inline PointCloud stroked(const MakeLimbTouch& make, const Limbs& limbs, BrushKind kind,
                          const std::vector<DVec3>& path) {
  double time_s = 0;
  const auto touch = make(limbs.cloud(), kLimbSupport, limbBrush(kind));
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

// Two rods of 6 mm along y, the pressed one about (0, y, -6), on its flank towards the other.
inline const DVec3 kAlongY{0, 1, 0};
inline LimbPlace onRod(double x) {
  return {{x, 0.2, std::sqrt(36 - x * x) - 6}, DVec3(x, 0, std::sqrt(36 - x * x)) / 6.0};
}
inline Limbs twoRods(double gap, bool random) {
  Limbs limbs(random);
  limbs.addRod({12 + gap, 0, -6}, kAlongY, 6, 50);
  limbs.addRod({0, 0, -6}, kAlongY, 6, 50);
  return limbs;
}

inline void checkRods(const MakeLimbTouch& make) {
  const LimbPlace place = onRod(4);
  for (const bool random : {false, true})
    for (const double gap : random ? std::array{0.6, 2.0} : std::array{0.3, 1.0}) {
      CAPTURE(random);
      CAPTURE(gap);
      const Limbs limbs = twoRods(gap * kLimbBrush, random);
      const std::size_t other = limbs.size() / 2;
      if (gap < 0.9) CHECK(insideBall(limbs.cloud(), other, place, 4) > 5);  // which a push without a limit would move
      const PointCloud after = stroked(make, limbs, BrushKind::push, pressed({place}, 4));
      CHECK(changedOf(limbs.cloud(), after, 0, other) == 0);
      CHECK(depthUnder(after, place) == near(4 - kLimbTau, random ? 0.15 : 0.05));
      // No point is between the rods.
      double farthest = 0;
      for (std::size_t i = other; i < after.size(); ++i)
        farthest = std::max(farthest, std::hypot(double{after.positions[i].x}, double{after.positions[i].z} + 6));
      CHECK(farthest < 6 + 0.25 * kLimbSpacing);
    }
}

inline void checkOtherBrushes(const MakeLimbTouch& make) {
  for (const auto& [name, kind] : kBrushKinds) {
    if (kind == BrushKind::carve || kind == BrushKind::push) continue;
    CAPTURE(name);
    const Limbs limbs = twoRods(0.3 * kLimbBrush, true);
    const std::size_t other = limbs.size() / 2;
    std::vector<DVec3> path = pressed({onRod(4)}, 3);
    if (kind == BrushKind::grab) path.push_back(path.back() + DVec3(2, 0, 2));
    const PointCloud after = stroked(make, limbs, kind, path);
    CHECK(changedOf(limbs.cloud(), after, 0, other) == 0);
    CHECK(changedOf(limbs.cloud(), after, other, limbs.size()) > 20);
  }
}

// A rod of 3 mm crosses over the pressed one, and the ball comes down beside it.
inline void checkCrossing(const MakeLimbTouch& make) {
  for (const double gap : {0.3, 0.7}) {
    CAPTURE(gap);
    Limbs limbs(false);
    limbs.addRod({0, 0, gap * kLimbBrush + 3}, {1, 0, 0}, 3, 50);
    const std::size_t other = limbs.size();
    limbs.addRod({0, 0, -6}, kAlongY, 6, 50);
    const LimbPlace place{{0, 6, 0}, {0, 0, 1}};
    CHECK(insideBall(limbs.cloud(), other, place, 3) > 20);
    const PointCloud after = stroked(make, limbs, BrushKind::push, pressed({place}, 3));
    CHECK(changedOf(limbs.cloud(), after, 0, other) == 0);
    CHECK(depthUnder(after, place) == near(3 - kLimbTau, 0.05));
  }
}

inline void checkPlates(const MakeLimbTouch& make) {
  for (const double gap : {0.3, 0.6}) {
    CAPTURE(gap);
    const LimbPlace place{{0.3, 0.2, 0}, {0, 0, 1}};
    Limbs limbs(false);
    limbs.addPlate({0, 0, -4 - gap * kLimbBrush}, 40, 4);
    const std::size_t other = limbs.size();
    limbs.addPlate({0, 0, 0}, 40, 4);
    const double depth = 4 + gap * kLimbBrush + 2;
    CHECK(insideBall(limbs.cloud(), other, place, depth) > 20);
    const PointCloud after = stroked(make, limbs, BrushKind::push, pressed({place}, depth));
    CHECK(changedOf(limbs.cloud(), after, 0, other) == 0);
    CHECK(depthUnder(after, place) > 2);
  }
}

// Both faces of an edge belong to it.
inline void checkEdge(const MakeLimbTouch& make) {
  Limbs limbs(false);
  limbs.addPlate({-15, 0, 0}, 30, 20);
  const LimbPlace place{{0, 0.2, 0}, glm::normalize(DVec3(1, 0, 1))};
  const PointCloud before = limbs.cloud(), after = stroked(make, limbs, BrushKind::push, pressed({place}, 4));
  std::size_t upper = 0, side = 0;
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    if (after.positions[i] == before.positions[i]) continue;
    upper += before.normals[i].z > 0.9f;
    side += before.normals[i].x > 0.9f;
  }
  CHECK(upper > 30);
  CHECK(side > 30);
  CHECK(depthUnder(after, place) == near(4 - kLimbTau, 0.1));
}

// A wall on a floor: a ball that is pressed into the wall and dragged along it is in the floor with its side. The floor
// yields downwards; along the tool's axis it would be dragged to the wall, and a hole would be left.
inline void checkCorner(const MakeLimbTouch& make) {
  constexpr double kHigh = 4, kDepth = 4;
  const LimbPlace from{{0, -8, kHigh}, {1, 0, 0}}, to{{0, 8, kHigh}, {1, 0, 0}};
  for (const bool random : {false, true}) {
    CAPTURE(random);
    Limbs limbs(random);
    limbs.addSheet({0, -25, 0}, {0, 50, 0}, {0, 0, 25});
    limbs.addSheet({0, -25, 0}, {25, 0, 0}, {0, 50, 0});
    const PointCloud before = limbs.cloud();
    CHECK(insideBall(before, before.size(), to, kDepth) > 100);
    const PointCloud after = stroked(make, limbs, BrushKind::push, pressed({from, to}, kDepth));
    CHECK(depthUnder(after, to) == near(kDepth - kLimbTau, random ? 0.15 : 0.05));
    CHECK(deepestInBall(after, to, kDepth) < 0.15);
    double lowest = 0;
    for (const Vec3& position : after.positions) lowest = std::min(lowest, double{position.z});
    CHECK(lowest == near(kHigh - kLimbBrush, 0.1));
    const auto gaps = [](const PointCloud& cloud) {
      return SurfaceGapFinder(cloud, kLimbSupport, kLimbSpacing).find([](const DVec3& at) {
        return std::abs(at.y) < 18 && at.x < 15 && at.z < 15;
      });
    };
    CHECK(gaps(after).widest <= std::max(1.4, gaps(before).widest));
  }
}

// The side of a plate, held 2 mm under its edge and dragged into it by far more than its upper face, which is in the
// brush with it, can be compressed: the edge goes with the side, and nothing is drawn through below the upper face.
inline void checkHeldEdge(const MakeLimbTouch& make) {
  const DVec3 held(0, 0.2, -2), in(-1, 0, 0);
  for (const bool random : {false, true}) {
    CAPTURE(random);
    Limbs limbs(random);
    limbs.addPlate({-15, 0, 0}, 30, 20);
    const PointCloud before = limbs.cloud();
    const PointCloud after = stroked(make, limbs, BrushKind::grab, {held - in, held + in, held + 10.0 * in});
    const auto between = [](double low, double value, double high) { return low < value && value < high; };
    double edge = -1e9, side = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const DVec3 place(after.positions[i]), normal(after.normals[i]);
      if (!between(-1, place.y - held.y, 1) || !between(-8, place.x, 1)) continue;
      if (normal.z > 0.7 && place.z > -0.3) edge = std::max(edge, place.x);
      if (normal.x > 0.7 && between(-2.5, place.z, -1)) side = std::min(side, place.x);
    }
    CHECK(side < -2);
    CHECK(edge < side + kLimbSpacing);
    const auto gaps = [](const PointCloud& cloud) {
      return SurfaceGapFinder(cloud, kLimbSupport, kLimbSpacing).find([](const DVec3& at) {
        return at.x > -12 && std::abs(at.y) < 10 && at.z > -12;
      });
    };
    CHECK(gaps(after).widest <= std::max(1.4, gaps(before).widest));
  }
}

// A crease between two rods that have grown together: a push into it presses both.
inline void checkMerged(const MakeLimbTouch& make) {
  Limbs limbs(false);
  const DVec3 left(-4.5, 0, -6), right(4.5, 0, -6);
  limbs.addRod(left, kAlongY, 6, 50);
  const std::size_t all = limbs.size();
  limbs.cut(0, all, right, kAlongY, 6);
  const std::size_t first = limbs.size();
  limbs.addRod(right, kAlongY, 6, 50);
  limbs.cut(first, limbs.size(), left, kAlongY, 6);
  const LimbPlace place{{0, 0.2, -6 + std::sqrt(36 - 4.5 * 4.5)}, {0, 0, 1}};
  const PointCloud after = stroked(make, limbs, BrushKind::push, pressed({place}, 3));
  CHECK(changedOf(limbs.cloud(), after, 0, first) > 30);
  CHECK(changedOf(limbs.cloud(), after, first, limbs.size()) > 30);
}

// The walls of a dent belong to the next stroke, which deepens and widens it.
inline void checkOwnDent(const MakeLimbTouch& make) {
  Limbs limbs(false);
  limbs.addSheet({-25, -25, 0}, {50, 0, 0}, {0, 50, 0});
  const auto touch = make(limbs.cloud(), kLimbSupport, limbBrush(BrushKind::push));
  double time_s = 0;
  const auto press = [&](const LimbPlace& place, double depth) {
    stroked(*touch, limbs.cloud(), {{0, 0, 20}, {0, 0, 21}}, time_s += 1);  // the stroke before is over
    return stroked(*touch, limbs.cloud(), pressed({place}, depth), time_s);
  };
  const LimbPlace middle{{-8.3, 0.2, 0}, {0, 0, 1}}, first{{8.3, 0.2, 0}, {0, 0, 1}}, beside{{11.3, 0.2, 0}, {0, 0, 1}};
  press(middle, 3);
  const PointCloud deeper = press(middle, 9);
  CHECK(depthUnder(deeper, middle) == near(8.5, 0.05));
  CHECK(deepestInBall(deeper, middle, 9) < 0.1);
  CHECK(depthUnder(press(first, 3), first) == near(2.5, 0.05));
  const PointCloud wider = press(beside, 3);
  CHECK(depthUnder(wider, first) == near(2.5, 0.1));
  CHECK(depthUnder(wider, beside) == near(2.5, 0.1));
}

// One press that is dragged from one rod to the other presses both.
inline void checkDragOver(const MakeLimbTouch& make) {
  const double gap = 0.3 * kLimbBrush;
  const Limbs limbs = twoRods(gap, false);
  const LimbPlace from = onRod(-1), to{{12 + gap + 1, 0.2, from.position.z}, {0, 0, 1}};
  const PointCloud after = stroked(make, limbs, BrushKind::push, pressed({from, to}, 3));
  CHECK(depthUnder(after, from) == near(3 - kLimbTau, 0.1));
  CHECK(depthUnder(after, to) == near(3 - kLimbTau, 0.1));
}

}  // namespace palpate
