#pragma once

#include <atomic>
#include <vector>

#include "haptics/session_log.hpp"

namespace palpate {

/// Ticks from the servo thread to a thread that writes them; neither waits for the other.
class TickRing {
 public:
  TickRing() : ring_(kTicks) {}

  /// For the thread that ticks. A tick without room is counted as lost.
  void add(const LoggedTick& tick) noexcept {
    const std::uint64_t next = added_.load(std::memory_order_relaxed);
    if (next - taken_.load(std::memory_order_acquire) == kTicks) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    ring_[next % kTicks] = tick;
    added_.store(next + 1, std::memory_order_release);
  }
  /// For the thread that writes: appends all added ticks to `ticks`.
  void take(std::vector<LoggedTick>& ticks) {
    const std::uint64_t begin = taken_.load(std::memory_order_relaxed), end = added_.load(std::memory_order_acquire);
    for (std::uint64_t i = begin; i < end; ++i) ticks.push_back(ring_[i % kTicks]);
    taken_.store(end, std::memory_order_release);
  }
  std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kTicks = 1 << 15;  // waiting at most: half a minute at 1 kHz

  std::vector<LoggedTick> ring_;
  std::atomic<std::uint64_t> added_ = 0, taken_ = 0, lost_ = 0;
};

}  // namespace palpate
