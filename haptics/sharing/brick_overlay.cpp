#include "haptics/sharing/brick_overlay.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

using sharing::MadeState;
using sharing::PointDigest;

void BrickOverlay::come(BrickKey key, const Brick* brick) {
  if (brick && !own_.empty())
    for (const std::uint32_t point : brick->ids)
      if (const auto own = own_.find(point); own != own_.end()) own->second.came = key;
  touched_.insert(key);
}

void BrickOverlay::settle(std::span<const std::uint32_t> points) {
  for (const std::uint32_t point : points) {
    const auto own = own_.find(point);
    if (own == own_.end() || own->second.isNew) continue;
    leave(own->second.made.state);
    touched_.insert(own->second.came);
    own_.erase(own);
  }
}

void BrickOverlay::make(std::span<const PointChange> changes, const Bricks& shown, Replaces replaces) {
  for (const PointChange& change : changes) {
    const std::uint32_t point = change.to.number;
    MadeState made{.state = change.to};
    if (replaces == Replaces::known) made.replaced = PointDigest::of(change.from);
    const auto [own, isFirst] = own_.try_emplace(point, Own{.made = made, .came = keyOf(change.from)});
    if (isFirst)
      touched_.insert(own->second.came = cameIn(point, own->second.came, shown));
    else
      leave(own->second.made.state);
    stand(change.to);
    if (std::exchange(own->second.isNew, true)) {
      own->second.made.followedBy(made);
    } else {
      own->second.made = made;
      made_.push_back(point);
    }
  }
}

// Since the point was read, a brick other than `where` may have been received with it.
BrickKey BrickOverlay::cameIn(std::uint32_t point, BrickKey where, const Bricks& shown) {
  const auto hasIt = [&](const Brick& brick) { return std::ranges::binary_search(brick.ids, point); };
  if (const auto there = shown.find(where); there != shown.end() && hasIt(*there->second)) return where;
  for (const auto& [key, brick] : shown)
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

void BrickOverlay::takeMade(std::vector<MadeState>& states) {
  for (const std::uint32_t point : made_) {
    Own& own = own_.at(point);
    own.isNew = false;
    states.push_back(own.made);
  }
  made_.clear();
}

std::set<BrickKey> BrickOverlay::takeTouched() { return std::exchange(touched_, {}); }

std::shared_ptr<const Brick> BrickOverlay::shown(BrickKey key, std::shared_ptr<const Brick> stored) const {
  if (!stored) return nullptr;
  const Brick& brick = *stored;
  const auto standing = standing_.find(key);
  bool isSame = standing == standing_.end();
  for (std::size_t i = 0; isSame && !own_.empty() && i < brick.size(); ++i) isSame = !own_.contains(brick.ids[i]);
  if (isSame) return stored;
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
      const PointState& state = own_.at(*next).made.state;
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
