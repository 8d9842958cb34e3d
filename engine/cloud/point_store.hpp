// Where the points of a cloud come from, block by block: a seam for code that needs only a part of them at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Grid of cubes (bricks) in which a cloud is sent piece by piece to a client that holds only part of it.
/// Packed coordinates of a brick; identical at both ends of a link.
using BrickKey = std::uint64_t;

/// Bricks from one corner to the other, both included.
struct BrickBox {
  IVec3 low{0}, high{-1};

  /// Number of bricks; a double, since it may exceed any integer type.
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
  BrickBox boxOf(const DVec3& low, const DVec3& high) const { return {brickAt(low), brickAt(high)}; }
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

/// Points of a brick by ascending id (their number in the whole cloud). Positions are relative to the cloud's origin.
struct Brick {
  std::vector<std::uint32_t> ids;
  std::vector<Vec3> positions, normals;
  std::vector<Vec3> velocities;       ///< empty where points do not move
  std::vector<std::uint32_t> colors;  ///< RGBA8, red in the lowest byte; 0: no colour. Empty if no point has a colour

  std::size_t size() const { return ids.size(); }
  bool operator==(const Brick&) const = default;
};

/// Colours that are all 0 count as none.
std::uint64_t checksumOf(const Brick& brick);

/// Number of times in a row that a damaged block is received before it is named, and no longer requested.
inline constexpr int kMaxDamaged = 3;

/// A brick as a store has it.
struct PointBlock {
  std::shared_ptr<const Brick> points;
  std::uint64_t version = 0;   ///< differs for every content that the block has had in its store
  std::uint64_t checksum = 0;  ///< checksumOf(*points), by the store
};

inline PointBlock blockOf(std::shared_ptr<const Brick> points, std::uint64_t version = 0) {
  const std::uint64_t checksum = checksumOf(*points);
  return {.points = std::move(points), .version = version, .checksum = checksum};
}

/// The points of a cloud by brick. A brick without points is a block, too. For one thread at a time.
class PointStore {
 public:
  virtual ~PointStore() = default;
  virtual const BrickGrid& grid() const = 0;
  /// Requests blocks, the most urgent first, in place of those requested before.
  virtual void want(std::span<const BrickKey> keys) = 0;
  /// Nothing: it is not here yet.
  virtual std::optional<PointBlock> get(BrickKey key) const = 0;
  /// Appends the keys of blocks that were received, changed or dropped since the last call, without those that want()
  /// finds here.
  virtual void takeNews(std::vector<BrickKey>& keys) = 0;
  /// The points of this block do not fit their checksum: it is dropped, and read or requested again.
  virtual void refuse(BrickKey key) = 0;
};

}  // namespace palpate
