// A client's points around its hands, as its server tracks them. Independent of DDS.
#pragma once

#include <cstddef>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "haptics/sharing/served_bricks.hpp"

namespace palpate::sharing {

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
