#include "haptics/sharing/brick_overlay.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

void BrickOverlay::come(BrickKey key, std::shared_ptr<const Brick> brick) {
  if (!own_.empty())
    for (const std::uint32_t point : brick->ids)
      if (const auto own = own_.find(point); own != own_.end()) own->second.came = key;
  come_[key] = std::move(brick);
  touched_.insert(key);
}

void BrickOverlay::drop(BrickKey key) {
  if (come_.erase(key) > 0) touched_.insert(key);
}

void BrickOverlay::settle(std::span<const std::uint32_t> points) {
  for (const std::uint32_t point : points) {
    const auto own = own_.find(point);
    if (own == own_.end() || own->second.isNew) continue;
    leave(own->second.state);
    touched_.insert(own->second.came);
    own_.erase(own);
  }
}

void BrickOverlay::make(std::span<const PointChange> changes) {
  for (const PointChange& change : changes) {
    const std::uint32_t point = change.to.number;
    const auto [own, isFirst] = own_.try_emplace(point, Own{.state = change.from, .came = keyOf(change.from)});
    if (isFirst)
      touched_.insert(own->second.came = cameIn(point, own->second.came));
    else
      leave(own->second.state);
    own->second.state = change.to;
    stand(change.to);
    if (!std::exchange(own->second.isNew, true)) made_.push_back(point);
  }
}

// Since the point was read, a brick other than `where` may have been received with it.
BrickKey BrickOverlay::cameIn(std::uint32_t point, BrickKey where) const {
  const auto hasIt = [&](const Brick& brick) { return std::ranges::binary_search(brick.ids, point); };
  if (const auto there = come_.find(where); there != come_.end() && hasIt(*there->second)) return where;
  for (const auto& [key, brick] : come_)
    if (hasIt(*brick)) return key;
  return where;
}

void BrickOverlay::stand(const PointState& state) {
  if (state.gone) return;
  const BrickKey key = keyOf(state);
  standing_[key].insert(state.number);
  touched_.insert(key);
}

void BrickOverlay::leave(const PointState& state) {
  if (state.gone) return;
  const auto there = standing_.find(keyOf(state));
  there->second.erase(state.number);
  touched_.insert(there->first);
  if (there->second.empty()) standing_.erase(there);
}

void BrickOverlay::takeMade(std::vector<PointState>& states) {
  for (const std::uint32_t point : made_) {
    Own& own = own_.at(point);
    own.isNew = false;
    states.push_back(own.state);
  }
  made_.clear();
}

std::set<BrickKey> BrickOverlay::takeTouched() { return std::exchange(touched_, {}); }

std::shared_ptr<const Brick> BrickOverlay::shown(BrickKey key) const {
  const auto came = come_.find(key);
  if (came == come_.end()) return nullptr;
  const Brick& brick = *came->second;
  const auto standing = standing_.find(key);
  bool isSame = standing == standing_.end();
  for (std::size_t i = 0; isSame && !own_.empty() && i < brick.size(); ++i) isSame = !own_.contains(brick.ids[i]);
  if (isSame) return came->second;
  const auto result = std::make_shared<Brick>();
  const auto add = [&](std::uint32_t id, const Vec3& position, const Vec3& normal, std::uint32_t color) {
    result->ids.push_back(id);
    result->positions.push_back(position);
    result->normals.push_back(normal);
    result->colors.push_back(color);
  };
  // Both are sorted by id, and no point is in both.
  static const std::set<std::uint32_t> kNone;
  const std::set<std::uint32_t>& own = standing == standing_.end() ? kNone : standing->second;
  auto next = own.begin();
  const auto addOwnBefore = [&](std::uint64_t id) {
    for (; next != own.end() && *next < id; ++next) {
      const PointState& state = own_.at(*next).state;
      add(*next, state.position, state.normal, state.color);
    }
  };
  for (std::size_t i = 0; i < brick.size(); ++i) {
    if (own_.contains(brick.ids[i])) continue;
    addOwnBefore(brick.ids[i]);
    add(brick.ids[i], brick.positions[i], brick.normals[i], brick.colors.empty() ? 0 : brick.colors[i]);
  }
  addOwnBefore(~std::uint64_t{0});
  return result;
}

}  // namespace palpate
