// What a client knows of the points around its hands, as its server has it. Nothing of DDS is seen here.
#pragma once

#include <cstddef>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "haptics/sharing/served_bricks.hpp"

namespace palpate::sharing {

/// What is wanted around a hand, relative to the cloud's origin.
struct Ball {
  DVec3 center{0};
  double radius = 0;
  bool operator==(const Ball&) const = default;
};

/// The longest radius that a client gets, in edges of a brick: whoever asks for more gets that.
inline constexpr double kMaxReach_edges = 14;
/// Balls of a client at a time.
inline constexpr std::size_t kMaxBalls = kMaxHands;

/// The bricks that the balls reach, those first that are next to the middle of one; each once.
std::vector<BrickKey> bricksIn(std::span<const Ball> balls, const BrickGrid& grid);

struct LedgerLimits {
  std::size_t known = 0;   ///< points that a client keeps, at most
  std::size_t atOnce = 0;  ///< points of a step; one brick goes in any case
};

/// Keeps a client's bricks: what it wants and has not, or has in an older version, is next, and what has gone far away
/// is dropped. What a client has of points that move is all of one time after each step.
class BrickLedger {
 public:
  struct Step {
    std::vector<BrickKey> dropped;
    std::vector<std::pair<BrickKey, std::shared_ptr<const Brick>>> bricks;
    bool whole = false;  ///< the client has all then that it wants, as far as there is room
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
    std::uint64_t wantedAt = 0;  // the step that wanted it last
  };
  void dropFar(std::span<const Ball> balls, const ServedBricks& bricks, std::size_t room, Step& step);

  std::unordered_map<BrickKey, Known> known_;
  std::size_t points_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace palpate::sharing
