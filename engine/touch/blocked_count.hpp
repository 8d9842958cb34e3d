#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>

#include "engine/core/edit_stream.hpp"

namespace palpate {

/// Adds up the blocked moves of brush edits. One thread writes, any thread reads.
class BlockedCount {
 public:
  /// Takes in an edit of that stroke: the points that were blocked, and those that changed otherwise. `meets`: whether
  /// points face the tool. A stroke that has reached points is not from behind, whatever it has left of them.
  void note(std::uint32_t stroke, std::uint64_t blocked, std::uint64_t changed, bool meets) noexcept {
    // Nearly all: of those that are not at rest, and not a few beside a brush that has reached its depth.
    constexpr std::uint64_t kChangedOf = 8, kShareOfMost = 4;
    if (std::exchange(stroke_, stroke) != stroke) most_ = 0;
    most_ = std::max(most_, blocked + changed);
    const bool nearlyAll = blocked > kChangedOf * changed && kShareOfMost * blocked >= most_;
    moves_.fetch_add(blocked, std::memory_order_relaxed);
    edits_.fetch_add(nearlyAll, std::memory_order_relaxed);
    fromBehind_.fetch_add(!meets && most_ == 0, std::memory_order_relaxed);
  }
  /// Takes in a tick in which a hand with its button pressed is behind the surface and touches nothing.
  void noteBehind() noexcept { fromBehind_.fetch_add(1, std::memory_order_relaxed); }
  BlockedMoves sum() const noexcept {
    return {.moves = moves_.load(std::memory_order_relaxed),
            .edits = edits_.load(std::memory_order_relaxed),
            .fromBehind = fromBehind_.load(std::memory_order_relaxed)};
  }

 private:
  std::uint32_t stroke_ = 0;
  std::uint64_t most_ = 0;  // points that one edit of the stroke has reached
  std::atomic<std::uint64_t> moves_ = 0, edits_ = 0, fromBehind_ = 0;
};

}  // namespace palpate
