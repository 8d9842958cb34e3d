#include "haptics/sharing/brick_ledger.hpp"

#include <algorithm>

#include <glm/common.hpp>

namespace palpate::sharing {

namespace {

constexpr double kKeptRadii = 1.3;        // bricks already sent are kept up to this multiple of a ball's radius
constexpr std::size_t kMaxKept = 60'000;  // bricks; the wanted ones are always fewer

}  // namespace

std::vector<BrickKey> bricksIn(std::span<const Ball> balls, const BrickGrid& grid) {
  std::vector<std::pair<double, BrickKey>> found;
  for (const Ball& ball : balls) {
    const double radius = std::min(ball.radius, kMaxReach_edges * grid.edge());
    grid.boxOf(ball.center - radius, ball.center + radius).forEach([&](const IVec3& brick) {
      const double distance = grid.distance(brick, ball.center);
      if (distance <= radius) found.emplace_back(distance, BrickGrid::keyOf(brick));
    });
  }
  if (balls.size() > 1) {  // for a brick that two balls reach the smaller distance counts
    std::ranges::sort(found, {}, [](const auto& one) { return std::pair(one.second, one.first); });
    const auto isSame = [](const auto& one, const auto& other) { return one.second == other.second; };
    found.erase(std::unique(found.begin(), found.end(), isSame), found.end());
  }
  std::ranges::sort(found);
  std::vector<BrickKey> keys;
  keys.reserve(found.size());
  for (const auto& [distance, key] : found) keys.push_back(key);
  return keys;
}

BrickLedger::Step BrickLedger::next(std::span<const Ball> balls, std::span<const BrickKey> wanted,
                                    const ServedBricks& bricks, const LedgerLimits& limits) {
  ++steps_;
  Step step;
  // Wanted bricks that fit, by distance.
  std::size_t points = 0, end = 0;
  for (; end < wanted.size(); ++end) {
    const std::size_t size = bricks.sizeOf(wanted[end]);
    if (points + size > limits.known) break;
    points += size;
    if (const auto there = known_.find(wanted[end]); there != known_.end()) there->second.wantedAt = steps_;
  }
  dropFar(balls, bricks, limits.known - points, step);
  std::size_t sent = 0;
  step.whole = true;
  for (const BrickKey key : wanted.first(end)) {
    if (!bricks.knows(key)) continue;  // sent with the next frame
    const std::uint32_t version = bricks.versionOf(key);
    const auto there = known_.find(key);
    if (there != known_.end() && there->second.version == version) continue;
    const std::size_t size = bricks.sizeOf(key);
    if (sent > 0 && sent + size > limits.atOnce) {
      step.whole = false;
      break;
    }
    sent += size;
    points_ += size - (there == known_.end() ? 0 : there->second.size);
    known_[key] = {.version = version, .size = size, .wantedAt = steps_};
    step.bricks.emplace_back(key, *bricks.get(key));
  }
  return step;
}

// Drops bricks that are not wanted: distant ones, changed ones, and any when there is no room.
void BrickLedger::dropFar(std::span<const Ball> balls, const ServedBricks& bricks, std::size_t room, Step& step) {
  const BrickGrid& grid = bricks.grid();
  const auto isNear = [&](BrickKey key) {
    return std::ranges::any_of(balls, [&](const Ball& ball) {
      const double radius = kKeptRadii * std::min(ball.radius, kMaxReach_edges * grid.edge()) + grid.edge();
      return grid.distance(BrickGrid::brickOf(key), ball.center) <= radius;
    });
  };
  std::size_t kept = 0;
  for (const auto& [key, known] : known_) {
    if (known.wantedAt == steps_) continue;
    const bool stays =
        known.version == bricks.versionOf(key) && kept + known.size <= room && known_.size() <= kMaxKept && isNear(key);
    if (stays)
      kept += known.size;
    else
      step.dropped.push_back(key);
  }
  for (const BrickKey key : step.dropped) {
    points_ -= known_.at(key).size;
    known_.erase(key);
  }
}

}  // namespace palpate::sharing
