// Large arrays that other code has as std::vector, which writes zeros into all of it on one thread.
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

/// As reserve(), in large pages where there are so many that it matters.
template <class T, class Allocator>
void reserveLarge(std::vector<T, Allocator>& values, std::size_t count) {
  constexpr std::uintptr_t kMask = kLargePage - 1;
  if (count <= values.capacity()) return;
  values.reserve(count);
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data());
  const std::uintptr_t first = (begin + kMask) & ~kMask, end = (begin + values.capacity() * sizeof(T)) & ~kMask;
  if (first + 4 * kLargePage <= end) askForLargePages(reinterpret_cast<void*>(first), end - first);
}

/// Makes an array longer while many threads fill what there is of it. To write zeros, as std::vector does, is work for
/// one thread at a time: whoever comes first does it, somewhat ahead of what is needed, and all who come help to fetch
/// the memory, each large page once (threads that meet in a page which is not there yet would all clear one).
template <class T, class Allocator = std::allocator<T>>
class GrowingArray {
 public:
  explicit GrowingArray(std::vector<T, Allocator>& values) : values_(values), there_(values.size()) {}

  /// The array may become as long as `count`, and no longer. Nobody else uses the array meanwhile: it may move.
  void makeRoom(std::size_t count) {
    constexpr std::uintptr_t kMask = kLargePage - 1;
    const std::uintptr_t before = addressOf(0);
    if (count > values_.capacity()) reserveLarge(values_, std::max(count, 2 * values_.capacity()));
    if (fetched_ == 0 || addressOf(0) != before) fetched_ = (addressOf(values_.size()) + kMask) & ~kMask;
    room_ = std::max(count, values_.size());
  }
  /// Returns when the array is as long as `count`, for which there is room. From any threads, which may use what was
  /// there before at the same time.
  void need(std::size_t count) {
    const std::size_t goal = std::min(room_, count + kAhead / sizeof(T));
    if (there_.load(std::memory_order_acquire) < goal) grow(count, goal);
  }
  /// Seconds for which threads waited for others to write zeros, all together.
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
  /// The next page that nobody has fetched, where one lies before `count`.
  void fetchOne(std::size_t count) {
    std::uintptr_t at = fetched_.load(std::memory_order_relaxed);
    while (at + kLargePage <= addressOf(count))
      if (fetched_.compare_exchange_weak(at, at + kLargePage))
        return fetchPages(reinterpret_cast<void*>(at), kLargePage);
  }

  std::vector<T, Allocator>& values_;
  std::size_t room_ = 0;
  std::atomic<std::size_t> there_;
  std::atomic<std::uintptr_t> fetched_ = 0;  // where the pages begin that nobody has fetched
  std::atomic<std::uint64_t> waited_us_ = 0;
  std::mutex growing_;
};

}  // namespace palpate
