#include "haptics/sharing/brick_ledger.hpp"

#include <algorithm>

#include <glm/common.hpp>

namespace palpate::sharing {

namespace {

constexpr BrickKey kNowhere = ~BrickKey{0};

constexpr double kKeptRadii = 1.3;        // bricks already sent are kept up to this multiple of a ball's radius
constexpr std::size_t kMaxKept = 60'000;  // bricks; the wanted ones are always fewer

}  // namespace

void ServedBricks::build(std::span<const PointState> points) {
  points_ = points;
  bricks_.clear();
  keys_.assign(points.size(), kNowhere);
  for (std::uint32_t id = 0; id < points.size(); ++id) {
    if (points[id].gone) continue;
    keys_[id] = keyOf(points[id]);
    bricks_[keys_[id]].ids.push_back(id);
  }
  ++version_;
}

void ServedBricks::follow(std::uint32_t id) {
  const BrickKey was = keys_[id], is = points_[id].gone ? kNowhere : keyOf(points_[id]);
  keys_[id] = is;
  ++version_;
  if (was != kNowhere) {
    Kept& before = bricks_[was];
    ++before.version;
    changed(was);
    if (is != was) before.ids.erase(std::ranges::lower_bound(before.ids, id));
  }
  if (is == kNowhere || is == was) return;
  Kept& now = bricks_[is];
  ++now.version;
  changed(is);
  now.ids.insert(std::ranges::lower_bound(now.ids, id), id);
}

void ServedBricks::show(const CloudFrame& frame, const std::unordered_set<BrickKey>& wanted) {
  moves_ = true;
  std::unordered_map<BrickKey, std::shared_ptr<Brick>> shown;
  for (const BrickKey key : wanted) shown.emplace(key, std::make_shared<Brick>());
  for (std::size_t i = 0; i < frame.size() && !shown.empty(); ++i) {
    const auto there = shown.find(grid_.keyAt(DVec3(frame.positions[i])));
    if (there == shown.end()) continue;
    Brick& brick = *there->second;
    brick.ids.push_back(frame.idOf(i));
    brick.positions.push_back(frame.positions[i]);
    brick.normals.push_back(frame.normals[i]);
    if (!frame.velocities.empty()) brick.velocities.push_back(frame.velocities[i]);
    if (!frame.colors.empty()) {
      const auto& color = frame.colors[i];
      brick.colors.push_back(packedColor({color[0], color[1], color[2], 255}));
    }
  }
  std::unordered_map<BrickKey, Kept> next;
  for (auto& [key, brick] : shown) {
    const std::uint64_t checksum = checksumOf(*brick);
    const auto before = bricks_.find(key);
    const bool isSame = before != bricks_.end() && before->second.checksum == checksum;
    // One version for all frames: a brick that was not wanted for a while is never mistaken for its earlier content.
    next[key] = {.version = isSame ? before->second.version : static_cast<std::uint32_t>(version_ + 1),
                 .ids = {},
                 .checksum = checksum,
                 .moving = std::move(brick)};
    if (!isSame) changed(key);
  }
  bricks_ = std::move(next);
  true_s_ = frame.time_s;
  ++version_;
}

std::uint32_t ServedBricks::versionOf(BrickKey key) const {
  const auto there = bricks_.find(key);
  return there == bricks_.end() ? 0 : there->second.version;
}

std::size_t ServedBricks::sizeOf(BrickKey key) const {
  const auto there = bricks_.find(key);
  if (there == bricks_.end()) return 0;
  return there->second.moving ? there->second.moving->size() : there->second.ids.size();
}

std::optional<PointBlock> ServedBricks::get(BrickKey key) const {
  if (!knows(key)) return std::nullopt;
  const auto there = bricks_.find(key);
  if (there != bricks_.end() && there->second.moving)
    return PointBlock{
        .points = there->second.moving, .version = there->second.version, .checksum = there->second.checksum};
  const auto brick = std::make_shared<Brick>();
  for (const std::uint32_t id : there == bricks_.end() ? std::span<const std::uint32_t>() : there->second.ids) {
    const PointState& point = points_[id];
    brick->ids.push_back(id);
    brick->positions.push_back(point.position);
    brick->normals.push_back(point.normal);
    brick->colors.push_back(point.color);
  }
  return blockOf(brick, versionOf(key));
}

void ServedBricks::takeNews(std::vector<BrickKey>& keys) {
  keys.insert(keys.end(), news_.begin(), news_.end());
  news_.clear();
}

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
