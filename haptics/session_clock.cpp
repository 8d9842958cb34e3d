#include "haptics/session_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "haptics/machine_time.hpp"

namespace palpate {
namespace {

class MachineClock final : public SessionClock {
 public:
  std::int64_t now_ns() const noexcept override { return machineTime_ns(); }
  void waitUntil_ns(std::int64_t time_ns) noexcept override { waitUntilMachineTime_ns(time_ns); }
};

}  // namespace

SessionClock& machineClock() noexcept {
  // Never destroyed: the thread of a driver that was not stopped still uses it while the process exits.
  alignas(MachineClock) static std::byte place[sizeof(MachineClock)];
  static auto& theMachines = *new (place) MachineClock;
  return theMachines;
}

std::int64_t SteppedClock::now_ns() const noexcept {
  const std::scoped_lock lock(guard_);
  return now_ns_;
}

void SteppedClock::waitUntil_ns(std::int64_t time_ns) noexcept {
  std::unique_lock lock(guard_);
  awaited_ns_ = time_ns;
  arrived_.notify_all();
  const auto isDue = [&] { return !held_ || time_ns <= limit_ns_; };
  while (!isDue()) {
    go_.wait(lock, [&] { return woken_ || isDue(); });
    if (!std::exchange(woken_, false) || !between_) continue;
    lock.unlock();
    between_();  // set by this thread
    lock.lock();
  }
  awaited_ns_ = kNotWaiting;
  now_ns_ = std::max(now_ns_, time_ns);
}

void SteppedClock::hold() noexcept {
  const std::scoped_lock lock(guard_);
  held_ = ticks_ = true;
  now_ns_ = std::max(now_ns_, limit_ns_);  // time without ticks is not made up for
}

void SteppedClock::leave() noexcept {
  const std::scoped_lock lock(guard_);
  ticks_ = false;
  arrived_.notify_all();
}

void SteppedClock::letGo() noexcept {
  const std::scoped_lock lock(guard_);
  held_ = false;
  go_.notify_all();
}

void SteppedClock::goOnTo(double time_s) noexcept {
  std::unique_lock lock(guard_);
  limit_ns_ = std::llround(time_s * 1e9);
  go_.notify_all();
  arrived_.wait(lock, [&] { return !ticks_ || awaited_ns_ > limit_ns_; });
}

void SteppedClock::serve(std::function<void()> between) {
  const std::scoped_lock lock(guard_);
  between_ = std::move(between);
}

void SteppedClock::wake() noexcept {
  const std::scoped_lock lock(guard_);
  woken_ = true;
  go_.notify_all();
}

void SteppedClock::passTo(double time_s) noexcept {
  const std::scoped_lock lock(guard_);
  now_ns_ = std::max<std::int64_t>(now_ns_, std::llround(time_s * 1e9));
}

}  // namespace palpate
