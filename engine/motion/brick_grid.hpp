// The cubes that space is divided into where a cloud is handed out piece by piece, to who has not all of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/core/vec.hpp"

namespace palpate {

/// Which brick; the same at both ends of a link.
using BrickKey = std::uint64_t;

/// Bricks from one corner to the other, both among them.
struct BrickBox {
  IVec3 low{0}, high{-1};

  /// How many; a double, since the answer may be far too many.
  double count() const {
    const DVec3 sides = DVec3(high) - DVec3(low) + 1.0;
    return sides.x * sides.y * sides.z;
  }
  template <class Visit>
  void forEach(Visit&& visit) const {
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) visit(IVec3(x, y, z));
  }
};

/// Bricks of one edge, model units, the first one from the cloud's origin on. What lies beyond the last one belongs to
/// that.
class BrickGrid {
 public:
  explicit BrickGrid(double edge) : edge_(edge) {}
  double edge() const { return edge_; }

  /// Never falls where a coordinate rises, so that the bricks of a box are those between its corners'.
  IVec3 brickAt(const DVec3& place) const {
    IVec3 brick;
    for (int k = 0; k < 3; ++k)
      brick[k] = static_cast<int>(std::clamp(std::floor(place[k] / edge_), double{-kReach}, double{kReach - 1}));
    return brick;
  }
  BrickKey keyAt(const DVec3& place) const { return keyOf(brickAt(place)); }
  BrickBox boxOf(const DVec3& low, const DVec3& high) const { return {brickAt(low), brickAt(high)}; }
  /// From the brick to the place; 0 within it.
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
  /// Whether a foreign key is one.
  static bool isKey(BrickKey key) { return key >> (3 * kBits) == 0; }

 private:
  static constexpr int kBits = 21;
  static constexpr int kReach = 1 << (kBits - 1);
  double edge_;
};

}  // namespace palpate
