// Grid of cubes (bricks) in which a cloud is sent piece by piece to a client that holds only part of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/core/cell_box.hpp"

namespace palpate {

/// Packed coordinates of a brick; identical at both ends of a link.
using BrickKey = std::uint64_t;

/// Bricks of one edge length (model units), starting at the cloud's origin. Positions beyond the outermost brick belong
/// to it.
class BrickGrid {
 public:
  explicit BrickGrid(double edge) : edge_(edge) {}
  double edge() const { return edge_; }

  /// Monotonic in each coordinate, so that the bricks of a box are those between the bricks of its corners.
  IVec3 brickAt(const DVec3& place) const {
    IVec3 brick;
    for (int k = 0; k < 3; ++k)
      brick[k] = static_cast<int>(std::clamp(std::floor(place[k] / edge_), double{-kReach}, double{kReach - 1}));
    return brick;
  }
  BrickKey keyAt(const DVec3& place) const { return keyOf(brickAt(place)); }
  CellBox boxOf(const DVec3& low, const DVec3& high) const { return {brickAt(low), brickAt(high)}; }
  /// Distance from the brick to the position; 0 inside it.
  double distance(const IVec3& brick, const DVec3& place) const {
    const DVec3 low = DVec3(brick) * edge_;
    return glm::length(glm::max(glm::max(low - place, place - (low + edge_)), DVec3(0)));
  }

  static BrickKey keyOf(const IVec3& brick) {
    BrickKey key = 0;
    for (int k = 2; k >= 0; --k) key = key << kBits | static_cast<BrickKey>(brick[k] + kReach);
    return key;
  }
  static IVec3 brickOf(BrickKey key) {
    IVec3 brick;
    for (int k = 0; k < 3; ++k) brick[k] = static_cast<int>(key >> (k * kBits) & (2 * kReach - 1)) - kReach;
    return brick;
  }
  /// Whether a key received from the other end is valid.
  static bool isKey(BrickKey key) { return key >> (3 * kBits) == 0; }

 private:
  static constexpr int kBits = 21;
  static constexpr int kReach = 1 << (kBits - 1);
  double edge_;
};

}  // namespace palpate
