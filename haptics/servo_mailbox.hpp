// Commands for a running servo loop: from any number of threads, run by the loop between two ticks.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <new>
#include <thread>
#include <type_traits>

#include "engine/core/error.hpp"

namespace palpate {

class SteppedClock;

/// The servo loop has not run a command in time: a tick hangs, or the device no longer calls its ticks. The command was
/// withdrawn and will not run.
class CommandTimeout : public Error {
 public:
  using Error::Error;
};

/// Slots of fixed size. The servo loop runs the commands between the end of a tick and its next read, in the order in
/// which they were posted, a few per tick: it never waits, takes no lock and allocates nothing. A poster waits for
/// its turn, and for a free slot while all are taken.
class ServoMailbox {
 public:
  static constexpr std::size_t kSlots = 8, kMaxPerTick = 4, kBytes = 64;
  static constexpr double kTimeout_s = 15;

  explicit ServoMailbox(double timeout_s = kTimeout_s) : timeout_s_(timeout_s) {}
  ServoMailbox(const ServoMailbox&) = delete;
  ServoMailbox& operator=(const ServoMailbox&) = delete;

  /// A loop is about to begin; posters wait for its ticks from now on. `clock`: of the loop, null for the machine's.
  void open(SteppedClock* clock = nullptr);
  /// The loop has ended. Commands that have not run are returned to their posters.
  void close() noexcept;
  bool isOpen() const noexcept { return open_.load(); }

  /// Runs `act` on the thread of the loop, and returns once it has run. False, without running it, where no loop runs
  /// or the loop ends first. Throws CommandTimeout, and Error on the thread of the loop, as in a force law.
  template <class Act>
  bool post(Act act) {
    static_assert(sizeof(Act) <= kBytes && alignof(Act) <= alignof(std::max_align_t));
    static_assert(std::is_trivially_copyable_v<Act> && std::is_nothrow_invocable_v<Act&>);
    return post([&](std::byte* room) { new (room) Act(act); },
                [](std::byte* room) noexcept { (*std::launder(reinterpret_cast<Act*>(room)))(); });
  }

  /// Ends the sleep of a loop that rests: something may move its hand, or stops it. For any thread; never waits.
  void wake() noexcept;
  // For the thread of the loop.
  std::uint32_t wakes() const noexcept { return wakes_.load(std::memory_order_acquire); }
  /// Sleeps while wakes() is `seen`.
  void sleep(std::uint32_t seen) const noexcept { wakes_.wait(seen, std::memory_order_acquire); }

  /// For the thread of the loop, between two ticks: runs the commands that wait, kMaxPerTick at most.
  void serve() noexcept;

 private:
  using Run = void (*)(std::byte* room) noexcept;
  enum class State : std::uint32_t { free, ready, running, done, withdrawn, returned };
  struct Slot {
    alignas(std::max_align_t) std::array<std::byte, kBytes> room;
    Run run = nullptr;
    std::atomic<State> state = State::free;
  };
  template <class Fill>
  bool post(const Fill& fill, Run run) {
    Slot* const slot = claim();
    if (!slot) return false;
    fill(slot->room.data());
    return finish(*slot, run);
  }
  // A free slot, with posting_ locked; null: no loop.
  Slot* claim();
  // Unlocks posting_ once the command is posted.
  bool finish(Slot& slot, Run run);
  // False if the loop has taken the command meanwhile.
  bool isWithdrawn(Slot& slot);

  double timeout_s_;
  std::array<Slot, kSlots> slots_;
  std::mutex posting_;        // among posters; the loop never takes it
  std::uint64_t next_ = 0;    // number of the next command; guarded by posting_
  std::uint64_t served_ = 0;  // number of commands that the loop has taken
  std::atomic<bool> open_ = false;
  std::atomic<std::thread::id> server_;  // the thread of the loop
  std::atomic<SteppedClock*> clock_ = nullptr;
  std::atomic<std::uint32_t> wakes_ = 0;  // number of calls of wake()
};

}  // namespace palpate
