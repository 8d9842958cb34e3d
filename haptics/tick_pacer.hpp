// Pacing for the servo loop.
#pragma once

#include <cstdint>

#include "haptics/session_clock.hpp"

namespace palpate {

/// Number of ticks of a session, at least one. Throws UsageError for a rate or a duration that is out of range.
std::uint64_t plannedTicks(double rate_Hz, double duration_s);

/// Tick i is due exactly i periods after the pacer was created, however long the ticks before it took.
class TickPacer {
 public:
  /// `wakesInTime`: the thread has real-time priority. Without it, the kernel may wake the thread hundreds of
  /// microseconds late. `clock`: null for the machine's; must outlive the pacer.
  TickPacer(double rate_Hz, bool wakesInTime, SessionClock* clock = nullptr) noexcept;

  /// Waits until tick `index` is due: sleeps, and spins for the last moment if there are cores to spare (for the last
  /// millisecond if it would not wake in time). Returns the tick to do now: `index`, or a later one if more than a
  /// whole period was missed. Ticks between are skipped; they are never made up for in a burst.
  std::uint64_t waitFor(std::uint64_t index) const noexcept;

  /// The last tick that is overdue by a whole period: ticks at a device's pace may be a little late.
  std::uint64_t passed() const noexcept;

  /// Time until tick `index` is due; negative once it is.
  double remaining_us(std::uint64_t index) const noexcept;

  /// Time that a query of tick `index` may take: until the next tick, less `reserve_us`, which is at most a fifth of a
  /// tick. At least 20 us, since 0 would mean no limit.
  double budget_us(std::uint64_t index, double reserve_us) const noexcept;

 private:
  std::int64_t due_ns(std::uint64_t index) const noexcept;

  SessionClock& clock_;
  double period_ns_;
  std::int64_t spin_ns_;  ///< at the end of each wait
  std::int64_t start_ns_;
};

}  // namespace palpate
