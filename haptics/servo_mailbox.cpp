#include "haptics/servo_mailbox.hpp"

#include <algorithm>
#include <chrono>

#include "engine/core/clock.hpp"
#include "haptics/session_clock.hpp"

namespace palpate {
namespace {

constexpr auto kPoll = std::chrono::microseconds(100);  // of a poster: a tenth of a tick

}  // namespace

void ServoMailbox::open(SteppedClock* clock) {
  const std::scoped_lock hold(posting_);
  served_ = next_;
  server_ = std::thread::id();
  clock_ = clock;
  open_ = true;
}

// A poster makes its slot ready and then reads open_; this writes open_ and then reads the slots. In a single order of
// all these accesses at least one side sees the other.
void ServoMailbox::close() noexcept {
  open_ = false;
  for (Slot& slot : slots_) {
    State state = State::ready;
    if (slot.state.compare_exchange_strong(state, State::returned)) continue;
    state = State::withdrawn;
    slot.state.compare_exchange_strong(state, State::free);
  }
}

void ServoMailbox::serve() noexcept {
  server_.store(std::this_thread::get_id(), std::memory_order_relaxed);
  for (std::size_t count = 0; count < kMaxPerTick;) {
    Slot& slot = slots_[served_ % kSlots];
    State state = slot.state;
    if (state == State::ready && slot.state.compare_exchange_strong(state, State::running)) {
      slot.run(slot.room.data());
      ++count;
      ++served_;
      slot.state = State::done;
    } else if (state == State::withdrawn) {
      ++served_;
      slot.state = State::free;
    } else {
      return;
    }
  }
}

// A held clock waits for the program, which may be waiting for its command.
void ServoMailbox::wake() noexcept {
  wakes_.fetch_add(1, std::memory_order_release);
  wakes_.notify_one();
  if (SteppedClock* const clock = clock_) clock->wake();
}

ServoMailbox::Slot* ServoMailbox::claim() {
  if (open_ && server_ == std::this_thread::get_id())
    throw Error("a command was given on the servo thread, which would wait for itself; give it on another thread");
  std::unique_lock hold(posting_);
  const Stopwatch since;
  while (open_) {
    Slot& slot = slots_[next_ % kSlots];
    if (slot.state == State::free) {
      hold.release();
      return &slot;
    }
    if (since.elapsed_s() > timeout_s_)
      throw CommandTimeout("the servo loop has {} commands that it has not run for {:.3g} s; stop the session", kSlots,
                           timeout_s_);
    wake();
    std::this_thread::sleep_for(kPoll);
  }
  return nullptr;
}

bool ServoMailbox::isWithdrawn(Slot& slot) {
  const std::scoped_lock hold(posting_);
  State state = State::ready;
  if (!slot.state.compare_exchange_strong(state, State::withdrawn)) return false;
  state = State::withdrawn;
  if (!open_) slot.state.compare_exchange_strong(state, State::free);  // close() may have passed it already
  return true;
}

bool ServoMailbox::finish(Slot& slot, Run run) {
  {
    const std::unique_lock hold(posting_, std::adopt_lock);
    slot.run = run;
    slot.state = State::ready;
    ++next_;
    State state = State::ready;
    if (!open_ && slot.state.compare_exchange_strong(state, State::free)) {
      --next_;
      return false;
    }
  }
  for (const Stopwatch since;;) {
    State state = slot.state;
    if (state == State::done || state == State::returned) {
      slot.state = State::free;
      return state == State::done;
    }
    if (state == State::ready && since.elapsed_s() > timeout_s_ && isWithdrawn(slot))
      throw CommandTimeout(
          "the servo loop has not run a command for {:.3g} s, and the command was withdrawn; stop the session",
          timeout_s_);
    wake();
    std::this_thread::sleep_for(kPoll);
  }
}

}  // namespace palpate
