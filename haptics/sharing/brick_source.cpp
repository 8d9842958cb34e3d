#include "haptics/sharing/brick_source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "engine/core/check.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kMaxReached = 1 << 15;  // maximum number of bricks that a hand may reach at a tick
constexpr double kStorePoll_s = 1e-3;    // of a store whose news are not reported

}  // namespace

double steadyNow_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

const BrickSource::Made* BrickSource::madeFor(double frame_s) const noexcept {
  for (const Made& made : frame_)
    if (made.time_s.load(std::memory_order_acquire) == frame_s) return &made;
  return nullptr;
}

std::uint64_t BrickSource::versionOf(double frame_s) const noexcept {
  const Made* const made = madeFor(frame_s);
  return made ? made->version : 0;
}

bool BrickSource::covers(double frame_s, const DVec3& low, const DVec3& high) const noexcept {
  const Made* const felt = madeFor(frame_s);
  const BrickBox box = grid_.boxOf(low, high);
  if (!felt || !isFinite(low) || !isFinite(high) || box.count() > kMaxReached) return false;
  bool all = true;
  box.forEach([&](const IVec3& brick) {
    all = all && std::binary_search(felt->keys.begin(), felt->keys.end(), BrickGrid::keyOf(brick));
  });
  return all;
}

bool BrickSource::knows(const HandReaches& hands) const {
  bool all = true;
  for (std::uint32_t i = 0; i < hands.count && all; ++i) {
    const BrickBox box = grid_.boxOf(hands.hands[i].low, hands.hands[i].high);
    if (box.count() > kMaxReached) return false;
    box.forEach([&](const IVec3& brick) { all = all && now_.bricks.contains(BrickGrid::keyOf(brick)); });
  }
  return all;
}

bool BrickSource::await(const HandReaches& hands, double timeout_s) { return await(hands, hands, timeout_s); }

bool BrickSource::await(const HandReaches& hands, const HandReaches& wide, double timeout_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  std::unique_lock hold(lock_);
  want(wide);
  for (;;) {
    takeNews();
    compose(From::store);
    const std::chrono::duration<double> left = end - std::chrono::steady_clock::now();
    if (isOver_ || left.count() <= 0 || (knows(hands) && (isWhole_ || knows(wide)))) break;
    came_.wait_for(hold, std::min(left, std::chrono::duration<double>(kStorePoll_s)));
  }
  if (!knows(hands)) return false;
  awaitedFor_s_ = hands.time_s;
  if (awaited_.version != now_.version) awaited_ = now_;
  return true;
}

// Requests the bricks that the hands reach, the nearest to the middle of a reach first.
void BrickSource::want(const HandReaches& hands) {
  std::vector<std::pair<double, BrickKey>> reached;
  for (std::uint32_t i = 0; i < hands.count; ++i) {
    const HandReach& hand = hands.hands[i];
    const BrickBox box = grid_.boxOf(hand.low, hand.high);
    if (!isFinite(hand.low) || !isFinite(hand.high) || box.count() > kMaxReached) continue;
    box.forEach([&](const IVec3& brick) {
      reached.emplace_back(grid_.distance(brick, 0.5 * (hand.low + hand.high)), BrickGrid::keyOf(brick));
    });
  }
  std::ranges::sort(reached);
  std::vector<BrickKey> keys;
  keys.reserve(reached.size());
  for (const auto& [distance, key] : reached) keys.push_back(key);
  if (keys == wanted_) return;
  wanted_ = std::move(keys);
  store_.want(wanted_);
  for (const BrickKey key : wanted_)
    if (!now_.bricks.contains(key)) take(key);
}

void BrickSource::take(BrickKey key) {
  const std::optional<PointBlock> block = store_.get(key);
  const bool isDamaged = block && checksumOf(*block->points) != block->checksum;
  if (isDamaged) {
    const IVec3 at = BrickGrid::brickOf(key);
    const int times = ++damaged_[key];
    if (times == kMaxDamaged)
      said_.push_back(
          fmt::format("the points of the block ({}, {}, {}) are damaged, and count as missing", at.x, at.y, at.z));
    if (times < kMaxDamaged) store_.refuse(key);
  } else if (block) {
    damaged_.erase(key);
  }
  overlay_.come(key, block && !isDamaged ? block->points.get() : nullptr);
}

// Null if the store does not have it, or not as it should be.
std::shared_ptr<const Brick> BrickSource::stored(BrickKey key) const {
  if (damaged_.contains(key)) return nullptr;
  std::optional<PointBlock> block = store_.get(key);
  return block ? std::move(block->points) : nullptr;
}

void BrickSource::takeNews() {
  news_.clear();
  store_.takeNews(news_);
  for (const BrickKey key : news_) take(key);
}

std::vector<std::string> BrickSource::takeSaid() {
  const std::scoped_lock hold(lock_);
  return std::exchange(said_, {});
}

bool BrickSource::takeRefused() {
  const std::scoped_lock hold(lock_);
  return received_.takeRefused();
}

void BrickSource::giveUp() {
  const std::scoped_lock hold(lock_);
  isOver_ = true;
  came_.notify_all();
}

bool BrickSource::isReached(const HandReaches& hands, BrickKey key) const {
  const IVec3 at = BrickGrid::brickOf(key);
  return std::any_of(hands.hands.begin(), hands.hands.begin() + hands.count, [&](const HandReach& hand) {
    const BrickBox box = grid_.boxOf(hand.low, hand.high);
    return glm::all(glm::lessThanEqual(box.low, at)) && glm::all(glm::lessThanEqual(at, box.high));
  });
}

// A brick that was not known, or has the same contents again, changes nothing under a hand.
bool BrickSource::compose(From changes) {
  const auto hands = asked_.load();
  bool isChanged = false, isAny = false;
  for (const BrickKey key : overlay_.takeTouched()) {
    isAny = true;
    std::shared_ptr<const Brick> brick = overlay_.shown(key, stored(key));
    if (brick && changes == From::store) followed_.show(key, *brick);
    const auto known = now_.bricks.find(key);
    if (known != now_.bricks.end()) {
      isChanged = isChanged || (brick && hands && *brick != *known->second && isReached(*hands, key));
      points_ -= known->second->size();
      now_.bricks.erase(known);
    }
    if (!brick) continue;
    if (brick->size() > options_.points - points_)
      throw Error("more than {} points were received for the region around the hands", options_.points);
    points_ += brick->size();
    now_.bricks.emplace(key, std::move(brick));
  }
  followed_.endStep();
  if (isAny) ++now_.version;
  return isChanged;
}

bool BrickSource::apply(BrickUpdate update) {
  const std::scoped_lock hold(lock_);
  PALPATE_CHECK(&store_ == &received_);
  for (const BrickKey key : update.dropped) received_.drop(key);
  for (auto& [key, block] : update.bricks) received_.receive(key, std::move(block));
  takeNews();
  overlay_.settle(update.settled);
  const bool isChanged = compose(From::store);
  if (std::exchange(now_.true_s, update.true_s) != update.true_s) ++now_.version;
  forces_.store({.true_s = update.true_s, .force_N = update.force_N});
  isWhole_ = update.whole;
  came_.notify_all();
  return isChanged;
}

void BrickSource::forget() {
  const std::scoped_lock hold(lock_);
  received_.clear();
  takeNews();
  compose(From::store);
}

void BrickSource::pointsIn(const DVec3& low, const DVec3& high, std::vector<PointState>& points) const {
  const std::scoped_lock hold(lock_);
  const BrickBox box = grid_.boxOf(low, high);
  const auto isIn = [&](const Vec3& place) {
    return glm::all(glm::lessThanEqual(low, DVec3(place))) && glm::all(glm::lessThanEqual(DVec3(place), high));
  };
  const auto take = [&](const Brick& brick) {
    for (std::size_t i = 0; i < brick.size(); ++i)
      if (isIn(brick.positions[i]))
        points.push_back({.position = brick.positions[i],
                          .number = brick.ids[i],
                          .normal = brick.normals[i],
                          .color = brick.colors.empty() ? 0 : brick.colors[i],
                          .parent = brick.ids[i]});
  };
  if (box.count() > static_cast<double>(now_.bricks.size())) {
    for (const auto& [key, brick] : now_.bricks) take(*brick);
    return;
  }
  box.forEach([&](const IVec3& brick) {
    if (const auto there = now_.bricks.find(BrickGrid::keyOf(brick)); there != now_.bricks.end()) take(*there->second);
  });
}

PointCloud BrickSource::cloud() const {
  std::vector<std::pair<std::uint32_t, std::pair<const Brick*, std::size_t>>> points;
  const std::scoped_lock hold(lock_);
  for (const auto& [key, brick] : now_.bricks)
    for (std::size_t i = 0; i < brick->size(); ++i) points.push_back({brick->ids[i], {brick.get(), i}});
  std::ranges::sort(points, {}, [](const auto& point) { return point.first; });
  PointCloud cloud;
  Attribute numbers{.name = "number", .type = ScalarType::u32, .data = {}};
  for (const auto& [number, where] : points) {
    const auto& [brick, i] = where;
    cloud.positions.push_back(brick->positions[i]);
    cloud.normals.push_back(brick->normals[i]);
    if (options_.colored) cloud.colors.push_back(unpackedColor(brick->colors.empty() ? 0 : brick->colors[i]));
    const auto bytes = std::as_bytes(std::span(&number, 1));
    numbers.data.insert(numbers.data.end(), bytes.begin(), bytes.end());
  }
  cloud.extra.push_back(std::move(numbers));
  return cloud;
}

std::uint64_t BrickSource::make(std::span<const PointChange> changes, std::uint32_t stroke) {
  const std::scoped_lock hold(lock_);
  overlay_.make(changes, now_.bricks, BrickOverlay::Replaces::any);
  compose(From::here);
  followed_.edited(changes, stroke);
  return now_.version;
}

void BrickSource::keepEdits() {
  const std::scoped_lock hold(lock_);
  followed_.keep();
}

void BrickSource::takeEdits(EditBatch& batch) {
  const std::scoped_lock hold(lock_);
  followed_.take(batch);
}

void BrickSource::endStroke() {
  const std::scoped_lock hold(lock_);
  followed_.endStroke();
}

std::uint64_t BrickSource::change(std::span<const PointChange> changes) {
  const std::scoped_lock hold(lock_);
  takeNews();
  compose(From::store);
  std::vector<PointChange> standing;
  for (const PointChange& change : changes)
    if (followed_.stands(change.from)) standing.push_back(change);
  overlay_.make(standing, now_.bricks, BrickOverlay::Replaces::known);
  compose(From::here);
  followed_.changed(standing);
  return now_.version;
}

void BrickSource::takeMade(std::vector<sharing::MadeState>& states) {
  const std::scoped_lock hold(lock_);
  overlay_.takeMade(states);
}

BrickSource::Known BrickSource::known() const {
  const std::scoped_lock hold(lock_);
  return {.bricks = now_.bricks.size(), .points = points_, .own = overlay_.own(), .allTaken = overlay_.allTaken()};
}

bool BrickSource::hasNewer(double time_s, double /*than_s*/) {
  const std::scoped_lock hold(lock_);
  if (const auto hands = asked_.load()) want(*hands);
  takeNews();
  compose(From::store);
  return stateFor(time_s).version != made_;
}

// Each frame has a unique time, by which covers() finds it.
double BrickSource::frameTime(double time_s, double true_s) {
  if (options_.moves) {
    if (const auto asked = asked_.load()) toSession_s_ = asked->time_s - asked->steady_s;
    if (toSession_s_) time_s = true_s + *toSession_s_;
  }
  constexpr double kBack_s = 0.5;  // a larger step back: the session was restarted
  if (lastTime_s_ && time_s <= *lastTime_s_ && time_s > *lastTime_s_ - kBack_s)
    time_s = std::nextafter(*lastTime_s_, std::numeric_limits<double>::infinity());
  lastTime_s_ = time_s;
  return time_s;
}

void BrickSource::makeFrame(double time_s, CloudFrame& frame) {
  Made& made = frame_[frames_++ % frame_.size()];
  made.time_s.store(std::numeric_limits<double>::quiet_NaN(), std::memory_order_release);
  made.keys.clear();
  taken_.clear();
  double true_s = 0;
  {
    const std::scoped_lock hold(lock_);
    const State& state = stateFor(time_s);
    for (const auto& [key, brick] : state.bricks) {
      made.keys.push_back(key);
      if (brick->size() > 0) taken_.push_back(brick);
    }
    made.version = made_ = state.version;
    true_s = state.true_s;
  }
  order_.clear();
  for (std::size_t b = 0; b < taken_.size(); ++b)
    for (std::size_t i = 0; i < taken_[b]->size(); ++i)
      order_.emplace_back(taken_[b]->ids[i], std::uint64_t{b} << 32 | i);
  std::ranges::sort(order_);
  frame.ids.clear();
  frame.colors.clear();
  for (std::vector<Vec3>* values : {&frame.positions, &frame.normals, &frame.velocities}) values->clear();
  for (const auto& [id, where] : order_) {
    const Brick& brick = *taken_[where >> 32];
    const std::size_t i = where & 0xffffffffu;
    frame.positions.push_back(brick.positions[i]);
    frame.normals.push_back(brick.normals[i]);
    if (options_.moves) frame.velocities.push_back(brick.velocities.empty() ? Vec3(0) : brick.velocities[i]);
    if (!options_.colored) continue;
    const std::uint32_t color = brick.colors.empty() ? 0 : brick.colors[i];
    const std::array<std::uint8_t, 4> rgba = unpackedColor(color);
    frame.colors.push_back({rgba[0], rgba[1], rgba[2]});
  }
  frame.time_s = frameTime(time_s, true_s);
  frame.extrapolationLimit_s = kMaxPointsAge_s;
  made.time_s.store(frame.time_s, std::memory_order_release);
}

}  // namespace palpate
