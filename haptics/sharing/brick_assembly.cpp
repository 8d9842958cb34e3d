#include "haptics/sharing/brick_assembly.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/check.hpp"

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxBricks = 200'000;  // known, or in one step

}  // namespace

std::uint32_t BrickAssembly::begin() {
  before_.insert(known_.begin(), known_.end());
  coming_.clear();
  comingPoints_ = 0;
  next_ = {};
  ready_.reset();
  return order_.begin();
}

void BrickAssembly::require(bool holds, const char* what) const {
  if (!holds) throw NetworkError("received invalid points around a hand: {}", what);
}

Heard BrickAssembly::hear(const Points& sample) {
  if (const Heard heard = order_.judge(sample.epoch, sample.sample); heard != Heard::taken) return heard;
  PALPATE_CHECK(!ready_);
  const std::size_t points = sample.points._length;
  require(sample.ids._length == points, "not every point has an id");
  require(sample.velocities._length == 0 || sample.velocities._length == 3 * points, "not every point has a velocity");
  require(std::isfinite(sample.true_s), "its time is not a number");
  const std::span<const float> forces(sample.forces._buffer, sample.forces._length);
  require(forces.empty() || forces.size() == 3 * kMaxHands, "not every hand has a force");
  require(std::ranges::all_of(forces, [](float part) { return std::isfinite(part); }), "a force is not a number");
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < sample.parts._length; ++i) {
    const BrickPart& part = sample.parts._buffer[i];
    require(BrickGrid::isKey(part.key), "a brick has an invalid position");
    if (part.total == kBrickDropped) {
      next_.dropped.push_back(part.key);
      require(next_.dropped.size() <= kMaxBricks, "too many bricks");
      continue;
    }
    require(part.count <= points - at, "points are missing");
    add(part, sample, at);
    at += part.count;
  }
  require(at == points && sample.states._length == 0, "points belong to no brick");
  order_.take();
  next_.true_s = sample.true_s;
  for (std::size_t i = 0; i < forces.size(); ++i) next_.force_N[i / 3][static_cast<int>(i % 3)] = forces[i];
  if (!sample.last) return Heard::taken;
  acked_ = std::max<std::uint64_t>(acked_, sample.acked);
  finish(sample.whole);
  return Heard::taken;
}

void BrickAssembly::add(const BrickPart& part, const Points& sample, std::size_t at) {
  Coming& coming = coming_[part.key];
  require(coming_.size() <= kMaxBricks, "too many bricks");
  if (!coming.brick) coming = {.total = part.total, .checksum = part.checksum, .brick = std::make_shared<Brick>()};
  Brick& brick = *coming.brick;
  require(part.checksum == coming.checksum, "a brick has two checksums");
  require(part.total == coming.total && part.count <= part.total - brick.size(),
          "a brick has more points than announced");
  comingPoints_ += part.count;
  require(comingPoints_ <= room_, "more points than there is room for");
  const bool moves = sample.velocities._length > 0;
  for (std::size_t i = at; i < at + part.count; ++i) {
    const Point& point = sample.points._buffer[i];
    const std::uint32_t id = sample.ids._buffer[i];
    const Vec3 place(point.position[0], point.position[1], point.position[2]),
        normal(point.normal[0], point.normal[1], point.normal[2]);
    require(isValid(point), "a point has no valid position or normal");
    require(grid_.keyAt(DVec3(place)) == part.key, "a point is in another brick");
    require(brick.ids.empty() || id > brick.ids.back(), "the ids of its points do not ascend");
    brick.ids.push_back(id);
    brick.positions.push_back(place);
    brick.normals.push_back(normal);
    brick.colors.push_back(point.color);
    if (!moves) continue;
    const float* const velocity = sample.velocities._buffer + 3 * i;
    brick.velocities.emplace_back(velocity[0], velocity[1], velocity[2]);
    require(isFinite(brick.velocities.back()), "a velocity is not a number");
  }
  require(brick.velocities.empty() || brick.velocities.size() == brick.size(), "not every point has a velocity");
}

void BrickAssembly::finish(bool whole) {
  for (auto& [key, coming] : coming_) {
    require(coming.brick->size() == coming.total, "a brick has fewer points than announced");
    next_.bricks.emplace_back(key, PointBlock{.points = std::move(coming.brick), .checksum = coming.checksum});
    before_.erase(key);
    known_.insert(key);
  }
  coming_.clear();
  comingPoints_ = 0;
  next_.whole = whole;
  if (whole) {
    next_.dropped.insert(next_.dropped.end(), before_.begin(), before_.end());
    before_.clear();
  }
  for (const BrickKey key : next_.dropped) {
    known_.erase(key);
    before_.erase(key);
  }
  require(known_.size() <= kMaxBricks, "too many bricks");
  for (const auto& [key, brick] : next_.bricks) known_.insert(key);  // dropped and sent again in one step
  ready_ = std::exchange(next_, {});
}

std::optional<BrickUpdate> BrickAssembly::takeUpdate() { return std::exchange(ready_, std::nullopt); }

}  // namespace palpate::sharing
