// The points that a server has, brick by brick. Nothing of DDS is seen here. One thread uses it at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/core/point_state.hpp"
#include "engine/motion/brick_source.hpp"

namespace palpate::sharing {

/// Each brick with a version, which grows with every change of its points. Of points that stand still all bricks are
/// kept, and follow what is done to them; of points that move those that somebody wants, from frame to frame.
class ServedBricks {
 public:
  explicit ServedBricks(double edge) : grid_(edge) {}
  const BrickGrid& grid() const { return grid_; }

  /// Of points that stand still, by id; `points` outlives it.
  void build(std::span<const PointState> points);
  /// The point of that id has changed.
  void follow(std::uint32_t id);
  /// Of points that move: where they are now, for the bricks that are wanted.
  void show(const CloudFrame& frame, const std::unordered_set<BrickKey>& wanted);
  /// When points that move are where they are.
  double true_s() const { return true_s_; }
  /// Grows whenever a brick does.
  std::uint64_t version() const { return version_; }

  /// False for a brick of points that move which was not wanted yet.
  bool knows(BrickKey key) const { return !moves_ || bricks_.contains(key); }
  /// Of a brick; empty ones have their version, too.
  std::uint32_t versionOf(BrickKey key) const;
  std::size_t sizeOf(BrickKey key) const;
  /// As it is now.
  std::shared_ptr<const Brick> brick(BrickKey key) const;

 private:
  struct Kept {
    std::uint32_t version = 1;
    std::vector<std::uint32_t> ids;  // of points that stand still
    std::uint64_t checksum = 0;      // of points that move, and those
    std::shared_ptr<const Brick> moving;
  };
  BrickKey keyOf(const PointState& point) const { return grid_.keyAt(DVec3(point.position)); }

  BrickGrid grid_;
  std::span<const PointState> points_;
  std::vector<BrickKey> keys_;  // by id: where the point is kept; kNowhere where it is gone
  std::unordered_map<BrickKey, Kept> bricks_;
  std::uint64_t version_ = 1;
  bool moves_ = false;
  double true_s_ = 0;
};

}  // namespace palpate::sharing
