#include "haptics/tick_pacer.hpp"

#include <pthread.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"

namespace palpate {
namespace {

constexpr double kHighestRate_Hz = 100'000;
constexpr double kMostTicks = 50'000'000;  // 14 hours at 1 kHz; their rows take about 10 GB

/// Waking up takes the kernel some tens of microseconds; spinning that long instead keeps a tick to the microsecond. A
/// longer spin only burns a core.
constexpr double kSpin_ns = 50'000;
constexpr double kMostOfPeriod = 0.5;  // at most this share is spun, so that the core is left to others every tick
/// Without real-time priority a thread that sleeps at all is now and then woken a whole tick late.
constexpr double kSpinWithoutPriority_ns = 1'000'000;
/// With fewer cores the spin would take the time of the driver's threads, on whose answer the tick depends.
constexpr int kCoresToSpin = 4;

int coresToUse() noexcept {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  return ::sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
}

}  // namespace

RealtimePriority::RealtimePriority() noexcept {
  oldSlack_ns_ = ::prctl(PR_GET_TIMERSLACK);
  ::prctl(PR_SET_TIMERSLACK, 1UL);  // 50 us by default, half a tick of 10 kHz; real-time threads have none
  if (::pthread_getschedparam(::pthread_self(), &oldPolicy_, &oldParameters_) != 0) return;
  // Above ordinary real-time work, below the kernel's own threads, whose interrupts the GPU's answer needs.
  const int lowest = ::sched_get_priority_min(SCHED_FIFO), highest = ::sched_get_priority_max(SCHED_FIFO);
  sched_param wanted{};
  wanted.sched_priority = lowest + (highest - lowest) * 2 / 5;
  granted_ = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &wanted) == 0;
}

RealtimePriority::~RealtimePriority() {
  if (granted_) ::pthread_setschedparam(::pthread_self(), oldPolicy_, &oldParameters_);
  if (oldSlack_ns_ > 0) ::prctl(PR_SET_TIMERSLACK, static_cast<unsigned long>(oldSlack_ns_));
}

std::uint64_t plannedTicks(double rate_Hz, double duration_s) {
  if (!(rate_Hz > 0 && rate_Hz <= kHighestRate_Hz))
    throw UsageError("rate {} Hz: it must be above 0 and at most {}", rate_Hz, kHighestRate_Hz);
  const double ticks = duration_s * rate_Hz;
  if (!(duration_s >= 0 && ticks <= kMostTicks))
    throw UsageError("{} s at {} Hz: a session has at most {} ticks; make it shorter", duration_s, rate_Hz, kMostTicks);
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(ticks)));
}

TickPacer::TickPacer(double rate_Hz, bool wakesInTime, SessionClock* clock) noexcept
    : clock_(clock ? *clock : machineClock()),
      period_ns_(1e9 / rate_Hz),
      spin_ns_(clock || coresToUse() < kCoresToSpin ? 0
               : wakesInTime ? std::llround(std::min(kSpin_ns, kMostOfPeriod * period_ns_))
                             : std::llround(std::min(kSpinWithoutPriority_ns, period_ns_))),
      start_ns_(clock_.now_ns()) {}

std::int64_t TickPacer::due_ns(std::uint64_t index) const noexcept {
  return start_ns_ + std::llround(static_cast<double>(index) * period_ns_);
}

std::uint64_t TickPacer::waitFor(std::uint64_t index) const noexcept {
  const std::int64_t due = due_ns(index);
  clock_.waitUntil_ns(due - spin_ns_);
  while (clock_.now_ns() < due) {
  }
  const auto late_ns = static_cast<double>(clock_.now_ns() - due);
  return late_ns > period_ns_ ? index + static_cast<std::uint64_t>(late_ns / period_ns_) : index;
}

std::uint64_t TickPacer::passed() const noexcept {
  const auto since_ns = static_cast<double>(clock_.now_ns() - start_ns_);
  return static_cast<std::uint64_t>(std::max(0.0, since_ns / period_ns_ - 1));
}

double TickPacer::remaining_us(std::uint64_t index) const noexcept {
  return static_cast<double>(due_ns(index) - clock_.now_ns()) * 1e-3;
}

}  // namespace palpate
