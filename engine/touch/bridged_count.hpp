#pragma once

#include <atomic>
#include <cstdint>

namespace palpate {

/// Ticks that the last patch answered, because their own answer was late; and those of them for which the patch had
/// only a share of its points.
struct BridgedTicks {
  std::uint64_t ticks = 0, thinned = 0;
};

/// Counts them. One thread writes, any thread reads.
class BridgedCount {
 public:
  void note(bool thinned) noexcept {
    ticks_.fetch_add(1, std::memory_order_relaxed);
    thinned_.fetch_add(thinned, std::memory_order_relaxed);
  }
  BridgedTicks sum() const noexcept {
    return {.ticks = ticks_.load(std::memory_order_relaxed), .thinned = thinned_.load(std::memory_order_relaxed)};
  }

 private:
  std::atomic<std::uint64_t> ticks_ = 0, thinned_ = 0;
};

}  // namespace palpate
