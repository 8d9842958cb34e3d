// Shapes with a known up direction, as random points with normals.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/up.hpp"
#include "engine/io/rgbd_folder.hpp"

namespace palpate::test::upright {

/// A sequence of random numbers.
struct Dice {
  std::uint64_t seed = 7, thrown = 0;
  double operator()(double from, double to) { return from + (to - from) * randomUnit(seed, thrown++); }
};

inline void add(PointCloud& cloud, const DVec3& place, const DVec3& normal) {
  cloud.positions.emplace_back(place);
  cloud.normals.emplace_back(glm::normalize(normal));
}

/// A parallelogram of uniformly random points.
inline void addFace(PointCloud& cloud, Dice& dice, const DVec3& corner, const DVec3& a, const DVec3& b,
                    double perArea) {
  const DVec3 across = glm::cross(a, b);
  const auto count = static_cast<int>(perArea * glm::length(across));
  for (int i = 0; i < count; ++i) add(cloud, corner + dice(0, 1) * a + dice(0, 1) * b, across);
}

inline void addBall(PointCloud& cloud, Dice& dice, const DVec3& center, double radius, int count) {
  for (int i = 0; i < count; ++i) {
    const double y = dice(-1, 1), angle = dice(0, 2 * std::numbers::pi), r = std::sqrt(1 - y * y);
    const DVec3 n(r * std::cos(angle), y, r * std::sin(angle));
    add(cloud, center + radius * n, n);
  }
}

// All shapes have y up.

/// A cone without its tip, on a flat base.
inline PointCloud statue() {
  PointCloud cloud;
  Dice dice;
  for (int i = 0; i < 20000; ++i) {
    const double t = 1 - std::sqrt(dice(0, 1)), r = 1 - 0.8 * t, angle = dice(0, 2 * std::numbers::pi);
    add(cloud, {r * std::cos(angle), 2.5 * t, r * std::sin(angle)}, {std::cos(angle), 0.3, std::sin(angle)});
  }
  for (int i = 0; i < 8000; ++i) {
    const double r = std::sqrt(dice(0, 1)), angle = dice(0, 2 * std::numbers::pi);
    add(cloud, {r * std::cos(angle), 0, r * std::sin(angle)}, {0, -1, 0});
  }
  return cloud;
}

/// An animal on four legs, with a head on a long neck in front of them.
inline PointCloud beast() {
  PointCloud cloud;
  Dice dice;
  for (int k = 0; k < 10; ++k) addBall(cloud, dice, {-0.9 + 0.2 * k, 1.8, 0}, 0.6, 2000);
  for (int leg = 0; leg < 4; ++leg) {
    const DVec3 foot(leg % 2 ? 0.8 : -0.8, 0, leg / 2 ? 0.3 : -0.3);
    for (int k = 0; k < 2000; ++k) {
      const double angle = dice(0, 2 * std::numbers::pi), r = 0.15 * std::sqrt(dice(0, 1));
      const DVec3 around(std::cos(angle), 0, std::sin(angle));
      if (k % 8)
        add(cloud, foot + 0.15 * around + DVec3(0, dice(0, 1.4), 0), around);
      else
        add(cloud, foot + r * around, {0, -1, 0});
    }
  }
  for (int k = 0; k < 8; ++k) addBall(cloud, dice, {1 + 0.08 * k, 1.8 + 0.1 * k, 0}, 0.18, 400);
  return cloud;
}

/// A floor with boxes and balls on it, seen from above.
inline PointCloud thingsOnFloor() {
  PointCloud cloud;
  Dice dice;
  addFace(cloud, dice, {0, 0, 0}, {0, 0, 4}, {5, 0, 0}, 1000);
  addBall(cloud, dice, {1, 0.5, 1}, 0.5, 3000);
  addBall(cloud, dice, {3.5, 1.2, 2.5}, 1.2, 9000);
  addFace(cloud, dice, {1, 1.5, 2.5}, {0, 0, 1}, {1, 0, 0}, 1000);
  addFace(cloud, dice, {1, 0, 3.5}, {1, 0, 0}, {0, 1.5, 0}, 1000);
  addFace(cloud, dice, {1, 0, 2.5}, {0, 1.5, 0}, {1, 0, 0}, 1000);
  return cloud;
}

/// Hills, seen from above.
inline PointCloud terrain() {
  PointCloud cloud;
  Dice dice;
  for (int i = 0; i < 30000; ++i) {
    const double x = dice(0, 10), z = dice(0, 8);
    const DVec3 slope(0.32 * std::cos(0.8 * x) * std::sin(1.1 * z), -1, 0.44 * std::sin(0.8 * x) * std::cos(1.1 * z));
    add(cloud, {x, 0.4 * std::sin(0.8 * x) * std::sin(1.1 * z), z}, -slope);
  }
  return cloud;
}

/// Walls and a gable roof; the floor was not scanned.
inline PointCloud building() {
  PointCloud cloud;
  Dice dice;
  addFace(cloud, dice, {0, 0, 0}, {0, 3, 0}, {10, 0, 0}, 300);
  addFace(cloud, dice, {0, 0, 4}, {10, 0, 0}, {0, 3, 0}, 300);
  addFace(cloud, dice, {0, 0, 0}, {0, 0, 4}, {0, 3, 0}, 300);
  addFace(cloud, dice, {10, 0, 0}, {0, 3, 0}, {0, 0, 4}, 300);
  addFace(cloud, dice, {0, 3, 0}, {0, 1.5, 2}, {10, 0, 0}, 300);
  addFace(cloud, dice, {0, 3, 4}, {10, 0, 0}, {0, 1.5, -2}, 300);
  return cloud;
}

/// A head, flat at its back and sides, hollow, with an open neck that contains a windpipe and a spine.
inline PointCloud headCutAtNeck() {
  PointCloud cloud;
  Dice dice;
  const auto addTube = [&](const DVec3& foot, double radius, double height, int count) {
    for (int i = 0; i < count; ++i) {
      const double angle = dice(0, 2 * std::numbers::pi);
      const DVec3 out(std::cos(angle), 0, std::sin(angle));
      add(cloud, foot + radius * out + DVec3(0, dice(0, height), 0), out);
    }
  };
  addTube({0, 0, 0}, 0.55, 0.8, 6000);
  addTube({0, 0, 0.3}, 0.12, 0.8, 1300);
  addTube({0, 0, -0.25}, 0.18, 1.0, 2200);
  for (int i = 0; i < 30000; ++i) {
    const double y = dice(-1, 1), angle = dice(0, 2 * std::numbers::pi), r = std::sqrt(1 - y * y);
    DVec3 n(r * std::cos(angle), y, r * std::sin(angle));
    DVec3 p(0.8 * n.x, 1.7 + 1.0 * n.y, n.z);
    if (p.y < 0.8 && std::hypot(p.x, p.z) < 0.55) continue;
    if (p.z < -0.7) {
      p.z = -0.7;
      n = {0, 0, -1};
    }
    if (std::abs(p.x) > 0.6) {
      n = {std::copysign(1, p.x), 0, 0};
      p.x = 0.6 * n.x;
    }
    add(cloud, p, n);
  }
  return cloud;
}

/// Roofs of houses as high as their distance, trees, and the ground between them, from straight above.
inline PointCloud townFromTheAir(double width, double length) {
  PointCloud cloud;
  Dice dice;
  for (int i = 0; i < 40000; ++i) {
    const double x = dice(0, width), z = dice(0, length);
    const int house = static_cast<int>(x / 20) * 7 + static_cast<int>(z / 20) * 13;
    const double inX = std::fmod(x, 20.0), inZ = std::fmod(z, 20.0);
    const bool isRoof = inX > 10 && inZ > 8;
    const bool isTree = !isRoof && std::hypot(inX - 5, inZ - 4) < 3;
    const double height = isRoof ? 14 + 4 * (house % 5) : isTree && dice(0, 1) < 0.6 ? dice(3, 9) : 0.02 * x;
    add(cloud, {x, height, z}, {-0.02, 1, 0});
  }
  return cloud;
}

/// A corner of a room with a cupboard, a bed and a lamp, seen by a camera at the opposite end: y up, the camera at +z.
inline PointCloud roomFromOneSide() {
  PointCloud cloud;
  Dice dice;
  addFace(cloud, dice, {0, 0, 0}, {0, 0, 1.7}, {4, 0, 0}, 1500);
  addFace(cloud, dice, {0, 0, 0}, {4, 0, 0}, {0, 2.5, 0}, 1500);
  addFace(cloud, dice, {0, 0.8, 0}, {0, 1.7, 0}, {0, 0, 1.4}, 800);
  addFace(cloud, dice, {2.5, 0, 0.6}, {1, 0, 0}, {0, 1.9, 0}, 1500);
  addFace(cloud, dice, {0.5, 0.5, 0.3}, {0, 0, 1.2}, {1.5, 0, 0}, 1500);
  addFace(cloud, dice, {0.5, 0, 1.5}, {1.5, 0, 0}, {0, 0.5, 0}, 1500);
  addBall(cloud, dice, {2.2, 1.2, 1}, 0.15, 300);
  return cloud;
}

/// A room with its ceiling and four walls, a bed, a table and a shelf, all seen from inside.
inline PointCloud roomFromWithin() {
  PointCloud cloud;
  Dice dice;
  addFace(cloud, dice, {0, 0, 0}, {0, 0, 4}, {5, 0, 0}, 500);
  addFace(cloud, dice, {0, 2.5, 0}, {5, 0, 0}, {0, 0, 4}, 500);
  addFace(cloud, dice, {0, 0, 0}, {5, 0, 0}, {0, 2.5, 0}, 500);
  addFace(cloud, dice, {0, 0, 4}, {0, 2.5, 0}, {5, 0, 0}, 500);
  addFace(cloud, dice, {0, 0, 0}, {0, 2.5, 0}, {0, 0, 4}, 500);
  addFace(cloud, dice, {5, 0, 0}, {0, 0, 4}, {0, 2.5, 0}, 500);
  const auto addBox = [&](const DVec3& low, const DVec3& size) {
    addFace(cloud, dice, low + DVec3(0, size.y, 0), {0, 0, size.z}, {size.x, 0, 0}, 500);
    addFace(cloud, dice, low + DVec3(0, 0, size.z), {size.x, 0, 0}, {0, size.y, 0}, 500);
    addFace(cloud, dice, low + DVec3(size.x, 0, 0), {0, size.y, 0}, {0, 0, size.z}, 500);
  };
  addBox({0, 0, 0}, {2, 0.5, 1.4});
  addBox({3, 0.7, 1.5}, {1.5, 0.1, 1});
  addBox({4, 0, 0}, {0.5, 1.3, 0.4});
  return cloud;
}

/// A skull without a jaw: a smooth egg with eye sockets and a nose at +z, broken bone below, and nothing flat under it.
inline PointCloud skull() {
  PointCloud cloud;
  Dice dice;
  for (int i = 0; i < 30000; ++i) {
    const double y = dice(-1, 1), angle = dice(0, 2 * std::numbers::pi), r = std::sqrt(1 - y * y);
    const DVec3 n(r * std::cos(angle), y, r * std::sin(angle));
    const auto dented = [&](const DVec3& at) { return glm::dot(n, glm::normalize(at)) > 0.95; };
    const bool isSocket = dented({0.5, -0.1, 1}) || dented({-0.5, -0.1, 1}) || dented({0, -0.6, 1});
    const double rough = y < -0.4 ? 0.08 * std::sin(25 * n.x) * std::sin(25 * n.z) : isSocket ? -0.2 : 0;
    const DVec3 tilt = y < -0.4   ? DVec3(std::cos(25 * n.x), 0, std::cos(25 * n.z))
                       : isSocket ? DVec3(std::sin(40 * n.x), std::sin(40 * n.y), 0)
                                  : DVec3(0);
    add(cloud, (1 + rough) * n * DVec3(0.7, 0.75, 0.9), n / DVec3(0.7, 0.75, 0.9) + tilt);
  }
  return cloud;
}

struct Named {
  std::string_view name;
  std::function<PointCloud()> make;
};
inline const Named kStanding[] = {{"statue", statue},
                                  {"beast", beast},
                                  {"things on a floor", thingsOnFloor},
                                  {"terrain", terrain},
                                  {"building", building}};

/// Rotates a cloud with y up and its front at +z.
inline PointCloud turned(PointCloud cloud, UpAxis up) {
  const DVec3 y = directionOf(up), z = frontOf(up), x = glm::cross(y, z);
  const auto turn = [&](Vec3& v) { v = Vec3(double{v.x} * x + double{v.y} * y + double{v.z} * z); };
  for (Vec3& p : cloud.positions) turn(p);
  for (Vec3& n : cloud.normals) turn(n);
  return cloud;
}

/// Rotates a cloud about y by quarters of a turn: the front moves from +z to +x.
inline PointCloud headed(PointCloud cloud, int quarters) {
  for (int k = 0; k < quarters; ++k) {
    for (Vec3& p : cloud.positions) p = Vec3(p.z, p.y, -p.x);
    for (Vec3& n : cloud.normals) n = Vec3(n.z, n.y, -n.x);
  }
  return cloud;
}

/// The points between two fractions of the longest side.
inline PointCloud sliceOf(const PointCloud& cloud, double from, double to) {
  const Bounds box = boundsOf(cloud);
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (box.max[k] - box.min[k] > box.max[axis] - box.min[axis]) axis = k;
  PointCloud slice;
  for (const Vec3& p : cloud.positions) {
    const double along = (double{p[axis]} - box.min[axis]) / (box.max[axis] - box.min[axis]);
    if (along >= from && along <= to) slice.positions.push_back(p);
  }
  return slice;
}

/// The points of a depth image, with the camera at the origin, y down and z ahead. Normals from neighbouring pixels.
inline PointCloud viewOf(const DepthFrame& frame, const DepthCamera& camera, bool withNormals) {
  PointCloud cloud;
  const auto place = [&](unsigned x, unsigned y) {
    const double depth = frame.depth_m[std::size_t{y} * camera.width + x];
    return depth * DVec3((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
  };
  for (unsigned y = 0; y + 3 < camera.height; y += 3)
    for (unsigned x = 0; x + 3 < camera.width; x += 3) {
      const DVec3 p = place(x, y), across = place(x + 3, y) - p, down = place(x, y + 3) - p;
      if (!(p.z > 0) || std::max(std::abs(across.z), std::abs(down.z)) > 0.05 * p.z) continue;
      cloud.positions.emplace_back(p);
      if (withNormals) cloud.normals.emplace_back(glm::normalize(glm::cross(down, across)));
    }
  return cloud;
}

inline void addOutliers(PointCloud& cloud, double share, double far) {
  Dice dice{.seed = 99};
  const Bounds box = boundsOf(cloud);
  const DVec3 half = DVec3(far * box.longestSide());
  const auto count = static_cast<std::size_t>(share * static_cast<double>(cloud.size()));
  for (std::size_t i = 0; i < count; ++i)
    add(cloud, box.center() + DVec3(dice(-1, 1), dice(-1, 1), dice(-1, 1)) * half, {0, 1, 0});
}

}  // namespace palpate::test::upright
