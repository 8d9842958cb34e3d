// Clouds as states, by number.
#pragma once

#include <random>
#include <vector>

#include "engine/core/point_state.hpp"

namespace palpate::select_test {

inline PointState pointAt(const DVec3& position, std::size_t number, const DVec3& normal = DVec3(0, 0, 1)) {
  return {.position = Vec3(position), .number = number, .normal = Vec3(normal), .parent = number};
}

/// In a box of side 2 around `middle`; some removed, some at the same position.
inline std::vector<PointState> scattered(std::size_t count, unsigned seed, const DVec3& middle = DVec3(0)) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> side(-1, 1);
  std::vector<PointState> points;
  for (std::size_t i = 0; i < count; ++i) {
    const DVec3 position = middle + DVec3{side(random), side(random), side(random)};
    points.push_back(pointAt(position, i, glm::normalize(DVec3{side(random), side(random), side(random) + 0.01})));
    points.back().gone = i % 11 == 5;
    if (i % 13 == 12) points.back().position = points[i - 1].position;
  }
  return points;
}

/// A closed ball of radius 50 around zero.
inline std::vector<PointState> ball(std::size_t count) {
  std::vector<PointState> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double angle = 2.399963229728653 * static_cast<double>(i), r = std::sqrt(1 - z * z);
    const DVec3 normal(r * std::cos(angle), r * std::sin(angle), z);
    points.push_back(pointAt(50.0 * normal, i, normal));
  }
  return points;
}

/// Two sheets of side x side points with spacing 1, three spacings apart; the upper one first.
inline std::vector<PointState> plate(int side) {
  std::vector<PointState> points;
  for (const double up : {1.0, -1.0})
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        points.push_back(pointAt({x - 0.5 * (side - 1), y - 0.5 * (side - 1), 1.5 * up}, points.size(), {0, 0, up}));
  return points;
}

}  // namespace palpate::select_test
