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
  const std::size_t mask = table_.size() - 1;
  const auto hash = [](const UVec3& v) { return v.x * 73856093u ^ v.y * 19349663u ^ v.z * 83492791u; };
  std::size_t slot = (hash(UVec3(box.low)) + 31 * hash(UVec3(box.high - box.low))) & mask;
  const bool isAlone = box.cells() > SortedGrid::kFewCells;
  while (!isAlone && table_[slot] != kNone) {
    Group& group = groups_[table_[slot]];
    GatheredPoints::Balls& balls = group.balls;
    if (balls.box.low == box.low && balls.box.high == box.high) {
      groupOf_[index] = table_[slot];
      ++group.count;
      balls.low = glm::min(balls.low, place);
      balls.high = glm::max(balls.high, place);
      balls.radius = std::max(balls.radius, radius);
      return;
    }
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

// Part k: groups from parts_[k] on.
void CellGroups::share(std::size_t fewest) {
  parts_.assign(1, 0);
  std::size_t positions = 0;
  for (std::uint32_t k = 0; k < groups_.size(); ++k) {
    positions += groups_[k].count;
    if (positions < fewest && k + 1 < groups_.size()) continue;
    parts_.push_back(k + 1);
    positions = 0;
  }
}

}  // namespace palpate
