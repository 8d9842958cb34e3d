#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

namespace palpate {

/// Lowers the priority of the calling thread: it and the threads that it starts get less time where cores are scarce,
/// and are preempted at once when others wake up. Permanent: an ordinary user cannot revert it. (On Windows threads
/// that it starts have the default priority.)
void giveWay() noexcept;

/// While it lives, a thread of this program has deadlines to meet: those of parallel work give way (parallelParts()).
class HasDeadlines {
 public:
  HasDeadlines() noexcept { ++count_; }
  ~HasDeadlines() { --count_; }
  HasDeadlines(const HasDeadlines&) = delete;
  HasDeadlines& operator=(const HasDeadlines&) = delete;

  /// Whether any lives now.
  static bool any() noexcept { return count_ > 0; }

 private:
  inline static std::atomic<int> count_ = 0;
};

/// The threads of this program at some time, to distinguish later ones. Empty if the system does not list threads.
class RunningThreads {
 public:
  /// Takes the current threads.
  RunningThreads();
  /// Lowers the priority of all threads started since.
  void laterOnesGiveWay() const noexcept;

 private:
  std::vector<std::uint32_t> threads_;  // their ids, sorted
};

/// While it lives, the calling thread and the threads that it starts avoid a core, if other cores are available: some
/// kernels do not preempt system calls, even long ones, for a thread that waits for its core.
class AwayFromCore {
 public:
  /// Negative: avoids no core.
  explicit AwayFromCore(int core) noexcept;
  ~AwayFromCore();
  AwayFromCore(const AwayFromCore&) = delete;
  AwayFromCore& operator=(const AwayFromCore&) = delete;

 private:
  std::array<std::uint64_t, 16> before_{};  // previous affinity mask, as the system stores it
  bool away_ = false;
};

}  // namespace palpate
