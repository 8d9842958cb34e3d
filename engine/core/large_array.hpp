// Large arrays that other code holds as std::vector, which zero-initialises all of it on one thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/large_pages.hpp"

namespace palpate {

/// As reserve(), in large pages if the array is large enough to benefit.
template <class T, class Allocator>
void reserveLarge(std::vector<T, Allocator>& values, std::size_t count) {
  constexpr std::uintptr_t kMask = kLargePage - 1;
  if (count <= values.capacity()) return;
  values.reserve(count);
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data());
  const std::uintptr_t first = (begin + kMask) & ~kMask, end = (begin + values.capacity() * sizeof(T)) & ~kMask;
  if (first + 4 * kLargePage <= end) askForLargePages(reinterpret_cast<void*>(first), end - first);
}

/// Extends an array while many threads fill it. Only one thread at a time can append zeros to a std::vector: the first
/// thread that needs more does it, somewhat ahead of the demand. All threads that need more help to fetch the memory,
/// each large page once (threads that meet in an absent page would all clear one).
template <class T, class Allocator = std::allocator<T>>
class GrowingArray {
 public:
  explicit GrowingArray(std::vector<T, Allocator>& values) : values_(values), there_(values.size()) {}

  /// Sets the maximum length to `count`. No other thread may use the array meanwhile: it may be reallocated.
  void makeRoom(std::size_t count) {
    constexpr std::uintptr_t kMask = kLargePage - 1;
    const std::uintptr_t before = addressOf(0);
    if (count > values_.capacity()) reserveLarge(values_, std::max(count, 2 * values_.capacity()));
    if (fetched_ == 0 || addressOf(0) != before) fetched_ = (addressOf(values_.size()) + kMask) & ~kMask;
    room_ = std::max(count, values_.size());
  }
  /// Returns when the array is at least `count` long, within makeRoom(). From any threads; the existing elements can be
  /// used meanwhile.
  void need(std::size_t count) {
    const std::size_t goal = std::min(room_, count + kAhead / sizeof(T));
    if (there_.load(std::memory_order_acquire) < goal) grow(count, goal);
  }
  /// Seconds for which threads waited for others to write zeros, in total.
  double waited_s() const { return 1e-6 * static_cast<double>(waited_us_.load()); }

 private:
  static constexpr std::size_t kAhead = 8 * kLargePage;  // bytes

  std::uintptr_t addressOf(std::size_t k) const { return reinterpret_cast<std::uintptr_t>(values_.data() + k); }

  void grow(std::size_t count, std::size_t goal) {
    fetchOne(std::min(room_, goal + kAhead / sizeof(T)));
    std::unique_lock hold(growing_, std::try_to_lock);
    if (!hold) {
      if (there_.load(std::memory_order_acquire) >= count) return;
      const Stopwatch watch;
      hold.lock();
      waited_us_ += static_cast<std::uint64_t>(watch.elapsed_us());
    }
    while (values_.size() < goal) {
      values_.resize(std::min(goal, values_.size() + kLargePage / sizeof(T)));
      there_.store(values_.size(), std::memory_order_release);
    }
  }
  /// Fetches the next page that was not fetched yet, if it lies before `count`.
  void fetchOne(std::size_t count) {
    std::uintptr_t at = fetched_.load(std::memory_order_relaxed);
    while (at + kLargePage <= addressOf(count))
      if (fetched_.compare_exchange_weak(at, at + kLargePage))
        return fetchPages(reinterpret_cast<void*>(at), kLargePage);
  }

  std::vector<T, Allocator>& values_;
  std::size_t room_ = 0;
  std::atomic<std::size_t> there_;
  std::atomic<std::uintptr_t> fetched_ = 0;  // start of the pages not fetched yet
  std::atomic<std::uint64_t> waited_us_ = 0;
  std::mutex growing_;
};

}  // namespace palpate
