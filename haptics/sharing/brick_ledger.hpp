// A client's points around its hands, as its server tracks them. Independent of DDS.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "engine/cloud/point_store.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/point_state.hpp"
#include "engine/motion/cloud_source.hpp"

namespace palpate::sharing {

/// A server's points, brick by brick. Independent of DDS. Not thread-safe.
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

/// Region wanted around a hand, relative to the cloud's origin.
struct Ball {
  DVec3 center{0};
  double radius = 0;
  bool operator==(const Ball&) const = default;
};

/// Maximum radius of a client's ball, in brick edges; larger requests are clamped to it.
inline constexpr double kMaxReach_edges = 14;
/// Maximum number of balls per client.
inline constexpr std::size_t kMaxBalls = kMaxHands;

/// Bricks that the balls reach, without duplicates, sorted by distance to the nearest center of a ball.
std::vector<BrickKey> bricksIn(std::span<const Ball> balls, const BrickGrid& grid);

struct LedgerLimits {
  std::size_t known = 0;   ///< maximum number of points that a client keeps
  std::size_t atOnce = 0;  ///< maximum number of points per step; one brick is sent in any case
};

/// Tracks a client's bricks. Bricks that the client wants and lacks, or has in an older version, are sent next; distant
/// ones are dropped. After each step all moving points of a client are of the same time.
class BrickLedger {
 public:
  struct Step {
    std::vector<BrickKey> dropped;
    std::vector<std::pair<BrickKey, PointBlock>> bricks;
    bool whole = false;  ///< after this step the client has all it wants, as far as there is room
    bool isEmpty() const { return dropped.empty() && bricks.empty(); }
  };
  /// `wanted`: bricksIn(balls).
  Step next(std::span<const Ball> balls, std::span<const BrickKey> wanted, const ServedBricks& bricks,
            const LedgerLimits& limits);
  std::size_t points() const { return points_; }
  std::size_t size() const { return known_.size(); }

 private:
  struct Known {
    std::uint32_t version = 0;
    std::size_t size = 0;
    std::uint64_t wantedAt = 0;  // last step that wanted it
  };
  void dropFar(std::span<const Ball> balls, const ServedBricks& bricks, std::size_t room, Step& step);

  std::unordered_map<BrickKey, Known> known_;
  std::size_t points_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace palpate::sharing
