#include "haptics/sharing/followed_points.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

void FollowedPoints::set(const PointState& state) {
  const auto [own, isFirst] = states_.try_emplace(state.number, state);
  if (!isFirst && !own->second.gone) standing_[keyOf(own->second)].erase(state.number);
  if (!state.gone) standing_[keyOf(state)].insert(state.number);
  own->second = state;
}

void FollowedPoints::receive(std::span<const PointState> states) {
  if (states.empty()) return;
  if (inStroke_) mark(EditMark::Kind::part);
  for (const PointState& state : states) {
    set(state);
    batch_.points.push_back(state);
  }
  mark(EditMark::Kind::received);
}

void FollowedPoints::edited(std::span<const PointChange> changes, std::uint32_t stroke) {
  if (!keeps_) return;
  if (std::exchange(stroke_, stroke) != stroke) endStroke();
  std::vector<PointState> before;
  for (const PointChange& change : changes)
    if (!states_.contains(change.from.number)) before.push_back(change.from);
  receive(before);
  for (const PointChange& change : changes) {
    set(change.to);
    batch_.points.push_back(change.to);
  }
  inStroke_ = true;
}

void FollowedPoints::endStroke() {
  if (std::exchange(inStroke_, false)) mark(EditMark::Kind::stroke);
}

void FollowedPoints::changed(std::span<const PointChange> changes) {
  endStroke();
  for (const PointChange& change : changes) {
    set(change.to);
    batch_.points.push_back(change.to);
  }
  mark(EditMark::Kind::change);
}

bool FollowedPoints::stands(const PointState& state) const {
  const auto own = states_.find(state.number);
  return own != states_.end() && isSameToTheBit(own->second, state);
}

void FollowedPoints::show(BrickKey key, const Brick& brick) {
  if (states_.empty()) return;
  for (std::size_t i = 0; i < brick.size(); ++i) {
    const auto own = states_.find(brick.ids[i]);
    if (own == states_.end()) continue;
    const PointState shown{.position = brick.positions[i],
                           .number = brick.ids[i],
                           .normal = brick.normals[i],
                           .color = brick.colors.empty() ? 0 : brick.colors[i],
                           .parent = brick.ids[i]};
    if (!isSameToTheBit(own->second, shown)) others_.push_back(shown);
  }
  const auto here = standing_.find(key);
  if (here == standing_.end()) return;
  for (const std::uint64_t point : here->second)
    if (!std::ranges::binary_search(brick.ids, point)) missing_.emplace_back(key, point);
}

void FollowedPoints::endStep() {
  receive(others_);
  others_.clear();
  for (const auto& [key, point] : missing_) {
    PointState state = states_.at(point);
    if (state.gone || keyOf(state) != key) continue;  // it is in another brick
    state.gone = true;
    others_.push_back(state);
  }
  missing_.clear();
  receive(others_);
  others_.clear();
}

void FollowedPoints::take(EditBatch& batch) {
  const std::size_t before = batch.points.size();
  batch.points.insert(batch.points.end(), batch_.points.begin(), batch_.points.end());
  for (const EditMark& mark : batch_.marks) batch.marks.push_back({before + mark.at, mark.kind});
  batch_.clear();
}

}  // namespace palpate
