// A server's points, brick by brick. Independent of DDS. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/cloud/point_store.hpp"
#include "engine/core/point_state.hpp"
#include "engine/motion/cloud_source.hpp"

namespace palpate::sharing {

/// A store of a whole cloud in memory. Each brick has a version, which grows with every change of its points. All
/// bricks of static points are kept and follow the edits; of moving points only the wanted bricks are kept, frame by
/// frame.
class ServedBricks final : public PointStore {
 public:
  explicit ServedBricks(double edge) : grid_(edge) {}
  const BrickGrid& grid() const override { return grid_; }
  void want(std::span<const BrickKey> keys) override { wanted_.insert(keys.begin(), keys.end()); }
  std::optional<PointBlock> get(BrickKey key) const override;
  void takeNews(std::vector<BrickKey>& keys) override;
  void refuse(BrickKey) override {}

  /// For static points, by id; `points` must outlive it.
  void build(std::span<const PointState> points);
  /// The point of that id has changed.
  void follow(std::uint32_t id);
  /// For moving points: their current positions, for the wanted bricks.
  void show(const CloudFrame& frame, const std::unordered_set<BrickKey>& wanted);
  /// Time of the moving points.
  double true_s() const { return true_s_; }
  /// Grows with the version of any brick.
  std::uint64_t version() const { return version_; }

  /// False for a brick of moving points that was not wanted yet.
  bool knows(BrickKey key) const { return !moves_ || bricks_.contains(key); }
  /// Version of a brick; empty ones have one, too.
  std::uint32_t versionOf(BrickKey key) const;
  std::size_t sizeOf(BrickKey key) const;

 private:
  struct Kept {
    std::uint32_t version = 1;
    std::vector<std::uint32_t> ids;  // static points
    std::uint64_t checksum = 0;      // of moving points, as is `moving`
    std::shared_ptr<const Brick> moving;
  };
  BrickKey keyOf(const PointState& point) const { return grid_.keyAt(DVec3(point.position)); }
  void changed(BrickKey key) {
    if (wanted_.contains(key)) news_.insert(key);
  }

  BrickGrid grid_;
  std::span<const PointState> points_;
  std::vector<BrickKey> keys_;  // by id: brick that holds the point; kNowhere if it is removed
  std::unordered_map<BrickKey, Kept> bricks_;
  std::unordered_set<BrickKey> wanted_, news_;  // by want(), ever; of these: since takeNews()
  std::uint64_t version_ = 1;
  bool moves_ = false;
  double true_s_ = 0;
};

}  // namespace palpate::sharing
