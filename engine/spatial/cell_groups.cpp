#include "engine/spatial/cell_groups.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace palpate {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

}  // namespace

void CellGroups::begin(std::size_t count) {
  groups_.clear();
  groupOf_.resize(count);
  members_.resize(count);
  table_.assign(std::bit_ceil(2 * count + 1), kNone);
}

void CellGroups::put(std::uint32_t index, const DVec3& place, double radius, const CellBox& box) {
  const auto add = [&](std::uint32_t number) {
    Group& group = groups_[number];
    groupOf_[index] = number;
    ++group.count;
    group.balls.low = glm::min(group.balls.low, place);
    group.balls.high = glm::max(group.balls.high, place);
    group.balls.radius = std::max(group.balls.radius, radius);
  };
  const auto isOf = [&](std::uint32_t number) {
    const CellBox& its = groups_[number].balls.box;
    return its.low == box.low && its.high == box.high;
  };
  const bool isAlone = box.cells() > SortedGrid::kFewCells;
  // Most are with the one before.
  if (!isAlone && index > 0 && isOf(groupOf_[index - 1])) return add(groupOf_[index - 1]);
  const std::size_t mask = table_.size() - 1;
  const auto hash = [](const UVec3& v) { return v.x * 73856093u ^ v.y * 19349663u ^ v.z * 83492791u; };
  std::size_t slot = (hash(UVec3(box.low)) + 31 * hash(UVec3(box.high - box.low))) & mask;
  while (!isAlone && table_[slot] != kNone) {
    if (isOf(table_[slot])) return add(table_[slot]);
    slot = (slot + 1) & mask;
  }
  groupOf_[index] = static_cast<std::uint32_t>(groups_.size());
  if (!isAlone) table_[slot] = groupOf_[index];
  groups_.push_back({{place, place, radius, box}, 0, 1});
}

void CellGroups::end() {
  std::uint32_t first = 0;
  for (Group& group : groups_) {
    group.first = first;
    first += group.count;
    group.count = 0;
  }
  for (std::size_t i = 0; i < groupOf_.size(); ++i) {
    Group& group = groups_[groupOf_[i]];
    members_[group.first + group.count++] = static_cast<std::uint32_t>(i);
  }
}

}  // namespace palpate
