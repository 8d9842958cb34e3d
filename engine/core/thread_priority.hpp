#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// The calling thread gives way to those that cannot wait: it and the threads that it starts get less time where cores
/// are short, and are put aside at once when others wake up. For good: an ordinary user cannot take it back. (On
/// Windows a thread that it starts begins as any other.)
void giveWay() noexcept;

/// The threads of this program at some time, to tell those that something has started since. Knows of none where the
/// system does not tell.
class RunningThreads {
 public:
  /// As of now.
  RunningThreads();
  /// Those that have come since give way, too.
  void laterOnesGiveWay() const noexcept;

 private:
  std::vector<std::uint32_t> threads_;  // their numbers, in order
};

/// While it lives, the calling thread and those that it starts stay away from a core, where there are others that they
/// may use: some kernels interrupt no call, not even a long one, for whoever waits for its core.
class AwayFromCore {
 public:
  /// Negative: away from none.
  explicit AwayFromCore(int core) noexcept;
  ~AwayFromCore();
  AwayFromCore(const AwayFromCore&) = delete;
  AwayFromCore& operator=(const AwayFromCore&) = delete;

 private:
  std::array<std::uint64_t, 16> before_{};  // the cores that it might use, as the system notes them
  bool away_ = false;
};

}  // namespace palpate
