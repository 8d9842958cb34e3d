#include "haptics/sharing/brick_source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kMaxBricks = 1 << 15;  // maximum number of bricks that a hand may reach at a tick

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
  if (!felt || !isFinite(low) || !isFinite(high) || box.count() > kMaxBricks) return false;
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
    if (box.count() > kMaxBricks) return false;
    box.forEach([&](const IVec3& brick) { all = all && now_.bricks.contains(BrickGrid::keyOf(brick)); });
  }
  return all;
}

bool BrickSource::await(const HandReaches& hands, double timeout_s) { return await(hands, hands, timeout_s); }

bool BrickSource::await(const HandReaches& hands, const HandReaches& wide, double timeout_s) {
  std::unique_lock hold(lock_);
  const auto enough = [&] { return isOver_ || (knows(hands) && (isWhole_ || knows(wide))); };
  came_.wait_for(hold, std::chrono::duration<double>(timeout_s), enough);
  if (!knows(hands)) return false;
  awaitedFor_s_ = hands.time_s;
  if (awaited_.version != now_.version) awaited_ = now_;
  return true;
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
bool BrickSource::compose() {
  const auto hands = asked_.load();
  bool isChanged = false;
  for (const BrickKey key : overlay_.takeTouched()) {
    std::shared_ptr<const Brick> brick = overlay_.shown(key);
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
  ++now_.version;
  return isChanged;
}

bool BrickSource::apply(BrickUpdate update) {
  const std::scoped_lock hold(lock_);
  for (const BrickKey key : update.dropped) overlay_.drop(key);
  for (auto& [key, brick] : update.bricks) overlay_.come(key, std::move(brick));
  overlay_.settle(update.settled);
  const bool isChanged = compose();
  now_.true_s = update.true_s;
  forces_.store({.true_s = update.true_s, .force_N = update.force_N});
  isWhole_ = update.whole;
  came_.notify_all();
  return isChanged;
}

void BrickSource::forget() {
  const std::scoped_lock hold(lock_);
  overlay_.forget();
  compose();
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

std::uint64_t BrickSource::make(std::span<const PointChange> changes) {
  const std::scoped_lock hold(lock_);
  overlay_.make(changes);
  compose();
  return now_.version;
}

void BrickSource::takeMade(std::vector<PointState>& states) {
  const std::scoped_lock hold(lock_);
  overlay_.takeMade(states);
}

BrickSource::Known BrickSource::known() const {
  const std::scoped_lock hold(lock_);
  return {.bricks = now_.bricks.size(), .points = points_, .own = overlay_.own(), .allTaken = overlay_.allTaken()};
}

bool BrickSource::hasNewer(double time_s, double /*than_s*/) {
  const std::scoped_lock hold(lock_);
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
