#include "engine/spatial/sorted_grid.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kMaxLowBits = 12;    // of a bucket number: the counters of a group then fit the L1 cache
constexpr std::size_t kSmallestPart = 8192;  // points; below this a thread costs more than it saves
constexpr std::size_t kGroupsPerThread = 8;  // taken in small batches, so that large groups do not leave threads idle

}  // namespace

SortedGrid::SortedGrid(const HashGrid& grid, unsigned threads)
    : grid_(grid), team_(threads), lowBits_((bucketBits(grid) + 1) / 2), groups_((grid.bucketMask >> lowBits_) + 1) {
  PALPATE_CHECK_LE(lowBits_, kMaxLowBits);
  parts_.resize(team_.size());
  for (Part& part : parts_) part.next.resize(groups_);
  grouped_.resize(groups_ + 1);
  starts_.assign(std::size_t{grid.bucketMask} + 2, 0);
}

void SortedGrid::build(std::span<const Vec3> positions, std::span<const std::uint8_t> there) {
  PALPATE_CHECK_LT(positions.size(), std::size_t{1} << 32);
  PALPATE_CHECK(there.empty() || there.size() == positions.size());
  positions_ = positions;
  there_ = there;
  const std::size_t count = positions.size();
  keys_.resize(count);
  halfway_.resize(count);
  halfwayLow_.resize(count);
  const std::size_t used = std::clamp<std::size_t>(count / kSmallestPart, 1, parts_.size());
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    parts_[k].begin = count * std::min(k, used) / used;
    parts_[k].end = count * std::min(k + 1, used) / used;
  }
  team_.forEach(used, [&](std::size_t k) { countGroups(parts_[k]); });
  placeParts();
  placed_.resize(grouped_[groups_]);
  team_.forEach(used, [&](std::size_t k) { scatterToGroups(parts_[k]); });
  const std::size_t runs = used == 1 ? 1 : std::min<std::size_t>(groups_, used * kGroupsPerThread);
  team_.forEach(runs, [&](std::size_t run) {
    for (std::size_t group = groups_ * run / runs; group < groups_ * (run + 1) / runs; ++group) sortGroup(group);
  });
  starts_.back() = grouped_[groups_];
}

void SortedGrid::countGroups(Part& part) {
  std::ranges::fill(part.next, 0);
  for (std::size_t i = part.begin; i < part.end; ++i) {
    if (!isThere(i)) continue;
    keys_[i] = bucketOf(grid_, cellOf(grid_, positions_[i]));
    ++part.next[keys_[i] >> lowBits_];
  }
}

void SortedGrid::placeParts() {
  // Group by group, and within a group part by part: this keeps the sort stable.
  std::uint32_t sum = 0;
  for (std::uint32_t group = 0; group < groups_; ++group) {
    grouped_[group] = sum;
    for (Part& part : parts_)
      if (part.begin < part.end) sum += std::exchange(part.next[group], sum);
  }
  grouped_[groups_] = sum;
}

void SortedGrid::scatterToGroups(Part& part) {
  const std::uint32_t lowMask = (1u << lowBits_) - 1;
  for (std::size_t i = part.begin; i < part.end; ++i) {
    if (!isThere(i)) continue;
    const std::uint32_t key = keys_[i], place = part.next[key >> lowBits_]++;
    halfway_[place] = {positions_[i], static_cast<std::uint32_t>(i)};
    halfwayLow_[place] = static_cast<LowBits>(key & lowMask);
  }
}

void SortedGrid::sortGroup(std::size_t group) {
  std::array<std::uint32_t, 1u << kMaxLowBits> next;
  const std::uint32_t buckets = 1u << lowBits_, begin = grouped_[group], end = grouped_[group + 1];
  std::fill_n(next.begin(), buckets, 0);
  for (std::uint32_t place = begin; place < end; ++place) ++next[halfwayLow_[place]];
  std::uint32_t* starts = starts_.data() + (group << lowBits_);
  std::uint32_t sum = begin;
  for (std::uint32_t bucket = 0; bucket < buckets; ++bucket) {
    starts[bucket] = sum;
    sum += std::exchange(next[bucket], sum);
  }
  for (std::uint32_t place = begin; place < end; ++place) placed_[next[halfwayLow_[place]]++] = halfway_[place];
}

void SortedGrid::move(std::span<const PointMove> moves) {
  if (!moves.empty()) build(positions_, there_);
}

void SortedGrid::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  forEachNear(center, radius, [&](const Placed& point) { found.push_back(point.number); });
}

std::size_t SortedGrid::bytes() const {
  const auto of = [](const auto& values) { return values.size() * sizeof(values[0]); };
  return of(keys_) + of(halfway_) + of(halfwayLow_) + of(placed_) + of(starts_) + of(grouped_) +
         parts_.size() * groups_ * sizeof(std::uint32_t);
}

}  // namespace palpate
