#pragma once

#include <algorithm>
#include <cstdint>

#include "shaders/shared/hash_compaction.h"

namespace palpate {

/// The slices of a compaction of the back half, one for each submission: first those that clear its slots, since any
/// slot may be the target of a copy, then those that copy the buckets.
class CompactionSlices {
 public:
  CompactionSlices(std::uint32_t slots, std::uint32_t buckets, std::uint32_t bucketsEach)
      : slots_(slots),
        buckets_(buckets),
        bucketsEach_(bucketsEach),
        clears_(count(slots, slotsEach())),
        copies_(count(buckets, bucketsEach)) {}

  std::uint32_t count() const { return clears_ + copies_; }
  std::uint32_t bucketsEach() const { return bucketsEach_; }
  void restart() { next_ = 0; }
  bool areDone() const { return next_ == count(); }
  shared::CompactionSlice next() {
    shared::CompactionSlice slice{.slots = {}, .buckets = {}};
    if (next_ < clears_)
      slice.slots = {next_ * slotsEach(), std::min(slots_, (next_ + 1) * slotsEach())};
    else
      slice.buckets = {(next_ - clears_) * bucketsEach_, std::min(buckets_, (next_ - clears_ + 1) * bucketsEach_)};
    ++next_;
    return slice;
  }

 private:
  // Number of slots that a slice clears for each bucket that it may copy.
  static constexpr std::uint32_t kSlotsPerBucket = 8;
  std::uint32_t slotsEach() const { return kSlotsPerBucket * bucketsEach_; }
  static std::uint32_t count(std::uint32_t all, std::uint32_t each) { return (all + each - 1) / each; }

  std::uint32_t slots_, buckets_, bucketsEach_;
  std::uint32_t clears_, copies_;
  std::uint32_t next_ = 0;
};

}  // namespace palpate
