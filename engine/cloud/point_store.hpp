// Where the points of a cloud come from, block by block: a seam for code that needs only a part of them at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/cloud/brick_grid.hpp"

namespace palpate {

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
