#include "haptics/tick_pacer.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"
#include "engine/core/processor.hpp"
#include "haptics/realtime_priority.hpp"

namespace palpate {
namespace {

constexpr double kHighestRate_Hz = 100'000;
constexpr double kMaxTicks = 50'000'000;  // 14 hours at 1 kHz; their rows take about 10 GB

/// Spinning for the system's wake-up latency keeps a tick to the microsecond; a longer spin only burns a core.
constexpr double kMaxOfPeriod = 0.5;  // maximum share that is spun, so that other threads get the core in every tick
/// Without real-time priority a thread that sleeps is sometimes woken a whole tick late.
constexpr double kSpinWithoutPriority_ns = 1'000'000;

constexpr double kSmallestBudget_us = 20;  // a budget of 0 would mean no limit
constexpr double kMaxReserve = 0.2;        // of a tick

}  // namespace

std::uint64_t plannedTicks(double rate_Hz, double duration_s) {
  if (!(rate_Hz > 0 && rate_Hz <= kHighestRate_Hz))
    throw UsageError("rate {} Hz: it must be above 0 and at most {}", rate_Hz, kHighestRate_Hz);
  const double ticks = duration_s * rate_Hz;
  if (!(duration_s >= 0 && ticks <= kMaxTicks))
    throw UsageError("{} s at {} Hz: a session has at most {} ticks; make it shorter", duration_s, rate_Hz, kMaxTicks);
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(ticks)));
}

TickPacer::TickPacer(double rate_Hz, bool wakesInTime, SessionClock* clock) noexcept
    : clock_(clock ? *clock : machineClock()),
      period_ns_(1e9 / rate_Hz),
      spin_ns_(clock || coresToUse() < kCoresToSpin ? 0
               : wakesInTime ? std::llround(std::min(static_cast<double>(RealtimePriority::wakesWithin_ns()),
                                                     kMaxOfPeriod * period_ns_))
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

double TickPacer::budget_us(std::uint64_t index, double reserve_us) const noexcept {
  return std::max(remaining_us(index + 1) - std::min(reserve_us, kMaxReserve * 1e-3 * period_ns_), kSmallestBudget_us);
}

}  // namespace palpate
