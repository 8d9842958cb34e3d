#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Default limit of extrapolation: moving points continue with their velocities for at most this long.
constexpr double kMaxPointsAge_s = 0.05;

/// The time for which the positions of moving points are true. Afterwards points continue with their velocities for at
/// most extrapolationLimit_s; before it they approach these positions for comes_s. Outside these intervals they stand
/// still.
struct PointsTime {
  double true_s = 0;
  double extrapolationLimit_s = kMaxPointsAge_s;
  double comes_s = 0;  ///< for this long before true_s, points approach with their velocities
};

/// Positions of a cloud's points at one time. It may contain fewer points than the cloud has ids: the other points are
/// absent.
struct CloudFrame {
  double time_s = 0;  ///< time for which the positions are true, or at which points start to approach them
  double extrapolationLimit_s = kMaxPointsAge_s;  ///< PointsTime::extrapolationLimit_s
  double comes_s = 0;                             ///< PointsTime::comes_s
  std::vector<Vec3> positions;                    ///< model units, relative to the cloud's origin
  std::vector<Vec3> normals;                      ///< unit
  std::vector<Vec3> velocities;                   ///< model units per second; empty where unknown
  bool slides = true;  ///< velocities include motion along the surface; false: only across it
  /// Change of the normals per second, as shaders/shared/motion.h applies it; empty where normals stay or the change is
  /// unknown.
  std::vector<Vec3> turns;
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< empty where points keep their colours
  std::vector<std::uint32_t> ids;  ///< ids of the points, ascending; empty where each id is the index here

  std::size_t size() const { return positions.size(); }
  PointsTime time() const {
    return {.true_s = time_s + comes_s, .extrapolationLimit_s = extrapolationLimit_s, .comes_s = comes_s};
  }
  std::uint32_t idOf(std::size_t i) const { return ids.empty() ? static_cast<std::uint32_t>(i) : ids[i]; }
};

}  // namespace palpate
