// Sorting into many buckets, with many threads.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/bare_vector.hpp"
#include "engine/core/check.hpp"
#include "engine/core/worker_team.hpp"

namespace palpate {

/// The bucket of what a BucketSort leaves out.
inline constexpr std::uint32_t kNoBucket = std::numeric_limits<std::uint32_t>::max();

/// Items sorted by bucket: a counting sort in two passes, first by the high bits of the bucket and then by the low
/// ones, whose counters fit the fastest cache. Stable for any number of threads. A sort of at most as many items as
/// before does not allocate.
template <class Item>
class BucketSort {
 public:
  explicit BucketSort(std::uint32_t buckets)
      : buckets_(buckets),
        lowBits_(std::min((static_cast<std::uint32_t>(std::bit_width(buckets - 1)) + 1) / 2, kMaxLowBits)),
        groups_(((buckets - 1) >> lowBits_) + 1) {
    PALPATE_CHECK_LT(0u, buckets);
    grouped_.resize(groups_ + 1);
    starts_.assign((std::size_t{groups_} << lowBits_) + 1, 0);
  }

  /// For every i in [0, count), fewer than 2^32, setItem(i, item) sets the item that is sorted by bucketOf(i); those in
  /// kNoBucket are left out. Both are called from the threads of `team`. (An item that is returned instead is built in
  /// parts and copied as a whole: g++ 12 then loses half of the speed.)
  template <class BucketOf, class SetItem>
  void sort(std::size_t count, WorkerTeam& team, BucketOf&& bucketOf, SetItem&& setItem);

  /// In the order of their buckets.
  std::span<const Item> items() const { return items_; }
  std::span<Item> items() { return items_; }
  /// Bucket of every i, for an owner that changes the items after the sort.
  BareVector<std::uint32_t>& keys() { return keys_; }
  /// Index of the first item of each bucket, and the number of items at the end.
  std::span<const std::uint32_t> starts() const { return std::span(starts_).first(std::size_t{buckets_} + 1); }
  std::size_t bytes() const {
    const auto of = [](const auto& values) { return values.size() * sizeof(values[0]); };
    return of(keys_) + of(halfway_) + of(halfwayLow_) + of(items_) + of(starts_) + of(grouped_) +
           parts_.size() * groups_ * sizeof(std::uint32_t);
  }

 private:
  static constexpr std::uint32_t kMaxLowBits = 12;    // the counters of a group then fit the L1 cache
  static constexpr std::size_t kSmallestPart = 8192;  // items; below this a thread costs more than it saves
  static constexpr std::size_t kGroupsPerThread = 8;  // taken in small batches: large groups leave no thread idle
  // Low bits of the bucket of an item that is sorted only by the high ones so far.
  using LowBits = std::uint16_t;
  // The range that one thread reads, and its next output index for each group of buckets.
  struct Part {
    std::size_t begin = 0, end = 0;
    std::vector<std::uint32_t> next;
  };
  void placeParts();
  void sortGroup(std::size_t group);

  std::uint32_t buckets_, lowBits_, groups_;
  std::vector<Part> parts_;
  BareVector<std::uint32_t> keys_;      // bucket of every i
  std::vector<std::uint32_t> grouped_;  // first item of every group of buckets
  BareVector<Item> halfway_, items_;
  BareVector<LowBits> halfwayLow_;
  std::vector<std::uint32_t> starts_;
};

template <class Item>
template <class BucketOf, class SetItem>
void BucketSort<Item>::sort(std::size_t count, WorkerTeam& team, BucketOf&& bucketOf, SetItem&& setItem) {
  PALPATE_CHECK_LT(count, std::size_t{1} << 32);
  keys_.resize(count);
  halfway_.resize(count);
  halfwayLow_.resize(count);
  parts_.resize(std::max(parts_.size(), team.size()));
  const std::size_t used = std::clamp<std::size_t>(count / kSmallestPart, 1, team.size());
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    parts_[k].begin = count * std::min(k, used) / used;
    parts_[k].end = count * std::min(k + 1, used) / used;
  }
  team.forEach(used, [&](std::size_t k) {
    Part& part = parts_[k];
    part.next.assign(groups_, 0);
    std::uint32_t *const next = part.next.data(), *const keys = keys_.data(), lowBits = lowBits_;
    for (std::size_t i = part.begin; i < part.end; ++i) {
      const std::uint32_t key = bucketOf(i);
      keys[i] = key;
      if (key != kNoBucket) ++next[key >> lowBits];
    }
  });
  placeParts();
  items_.resize(grouped_[groups_]);
  team.forEach(used, [&](std::size_t k) {
    Part& part = parts_[k];
    const std::uint32_t lowBits = lowBits_, lowMask = (1u << lowBits) - 1, *const keys = keys_.data();
    std::uint32_t* const next = part.next.data();
    Item* const halfway = halfway_.data();
    LowBits* const halfwayLow = halfwayLow_.data();
    for (std::size_t i = part.begin; i < part.end; ++i) {
      const std::uint32_t key = keys[i];
      if (key == kNoBucket) continue;
      const std::uint32_t place = next[key >> lowBits]++;
      setItem(i, halfway[place]);
      halfwayLow[place] = static_cast<LowBits>(key & lowMask);
    }
  });
  const std::size_t runs = used == 1 ? 1 : std::min<std::size_t>(groups_, used * kGroupsPerThread);
  team.forEach(runs, [&](std::size_t run) {
    for (std::size_t group = groups_ * run / runs; group < groups_ * (run + 1) / runs; ++group) sortGroup(group);
  });
  starts_.back() = grouped_[groups_];
}

template <class Item>
void BucketSort<Item>::placeParts() {
  // Group by group, and within a group part by part: this keeps the sort stable.
  std::uint32_t sum = 0;
  for (std::uint32_t group = 0; group < groups_; ++group) {
    grouped_[group] = sum;
    for (Part& part : parts_)
      if (part.begin < part.end) sum += std::exchange(part.next[group], sum);
  }
  grouped_[groups_] = sum;
}

template <class Item>
void BucketSort<Item>::sortGroup(std::size_t group) {
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
  for (std::uint32_t place = begin; place < end; ++place) items_[next[halfwayLow_[place]]++] = halfway_[place];
}

}  // namespace palpate
