#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// So long at most points that move go on with their velocities, where their source says nothing else.
constexpr double kMaxPointsAge_s = 0.05;

/// When points that move are where they are. From then on they go on with their velocities, for so long at most; after
/// that they stand still, as they do before they begin to come there.
struct PointsTime {
  double true_s = 0;
  double goOn_s = kMaxPointsAge_s;
  double comes_s = 0;  ///< so long they come there with their velocities
};

/// Where the points of a cloud are at one time. It may have fewer points than the cloud has ids: the others are not
/// there.
struct CloudFrame {
  double time_s = 0;                ///< that it is true for, or from which on its points come there
  double goOn_s = kMaxPointsAge_s;  ///< PointsTime::goOn_s
  double comes_s = 0;               ///< PointsTime::comes_s
  std::vector<Vec3> positions;      ///< model units, relative to the cloud's origin
  std::vector<Vec3> normals;        ///< unit
  std::vector<Vec3> velocities;     ///< model units per second; empty where they are not known
  bool slides = true;               ///< velocities say how a surface goes along itself, too; false: only how across
  /// Of the normals, a second, as shaders/shared/motion.h turns them; empty where they stay, or nobody knows.
  std::vector<Vec3> turns;
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< empty where points keep theirs
  std::vector<std::uint32_t> ids;  ///< of the points, ascending; empty where each one's is its place here

  std::size_t size() const { return positions.size(); }
  PointsTime time() const { return {.true_s = time_s + comes_s, .goOn_s = goOn_s, .comes_s = comes_s}; }
  std::uint32_t idOf(std::size_t i) const { return ids.empty() ? static_cast<std::uint32_t>(i) : ids[i]; }
};

}  // namespace palpate
