// Blocks of slots for buckets that outgrow their own.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "engine/core/check.hpp"

namespace palpate {

/// Blocks of consecutive slots, their sizes powers of two. A block given back serves the next request of its size, and
/// a request never moves other blocks: memory is bounded by the most blocks of each size in use at once, and no
/// request takes longer the more there are.
template <class Item>
class SpareBlocks {
 public:
  /// Number of slots of the block that take(count) gives.
  static std::uint32_t slotsFor(std::uint32_t count) { return std::bit_ceil(std::max(count, kFewestSlots)); }
  /// A block of at least `count` slots; its items are not initialised.
  std::uint32_t take(std::uint32_t count);
  void giveBack(std::uint32_t block) { free_[sizeBits_[block / kPage]].push_back(block); }
  /// Number of slots of a block.
  std::uint32_t slots(std::uint32_t block) const { return 1u << sizeBits_[block / kPage]; }
  Item* at(std::uint32_t block) { return pages_[block / kPage] + block % kPage; }
  const Item* at(std::uint32_t block) const { return pages_[block / kPage] + block % kPage; }
  /// Gives all blocks back.
  void clear();
  std::size_t bytes() const {
    return pages_.size() * (kPage * sizeof(Item) + sizeof(Item*) + sizeof(std::uint8_t) + sizeof(std::uint32_t));
  }

 private:
  static constexpr std::uint32_t kPage = 1024;  // slots
  static constexpr std::uint32_t kFewestSlots = 8;
  void addPages(std::uint32_t sizeBits);

  std::vector<std::unique_ptr<Item[]>> memory_;
  std::vector<Item*> pages_;                         // a block larger than a page has several, in a row
  std::vector<std::uint8_t> sizeBits_;               // by page: logarithm of its blocks' slots
  std::array<std::vector<std::uint32_t>, 32> free_;  // by size: blocks
};

template <class Item>
std::uint32_t SpareBlocks<Item>::take(std::uint32_t count) {
  const auto sizeBits = static_cast<std::uint32_t>(std::countr_zero(slotsFor(count)));
  std::vector<std::uint32_t>& free = free_[sizeBits];
  if (free.empty()) addPages(sizeBits);
  const std::uint32_t block = free.back();
  free.pop_back();
  return block;
}

template <class Item>
void SpareBlocks<Item>::addPages(std::uint32_t sizeBits) {
  const std::uint32_t slots = std::max(1u << sizeBits, kPage);
  const std::size_t first = pages_.size() * kPage;
  PALPATE_CHECK_LT(first + slots, std::size_t{std::numeric_limits<std::uint32_t>::max()});
  memory_.push_back(std::make_unique_for_overwrite<Item[]>(slots));
  for (std::uint32_t slot = 0; slot < slots; slot += kPage) {
    pages_.push_back(memory_.back().get() + slot);
    sizeBits_.push_back(static_cast<std::uint8_t>(sizeBits));
  }
  // The first one is taken first.
  for (std::uint32_t end = slots; end > 0; end -= 1u << sizeBits)
    free_[sizeBits].push_back(static_cast<std::uint32_t>(first) + end - (1u << sizeBits));
}

template <class Item>
void SpareBlocks<Item>::clear() {
  memory_.clear();
  pages_.clear();
  sizeBits_.clear();
  for (std::vector<std::uint32_t>& free : free_) free.clear();
}

}  // namespace palpate
