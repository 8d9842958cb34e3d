// Pacing for the servo loop.
#pragma once

#include <cstdint>

#include "haptics/session_clock.hpp"

namespace palpate {

/// The ticks of a session, at least one. Throws UsageError for a rate or a duration that is out of range.
std::uint64_t plannedTicks(double rate_Hz, double duration_s);

/// Tick i is due exactly i periods after the pacer was made, however long the ticks before it took.
class TickPacer {
 public:
  /// `wakesInTime`: the thread has real-time priority. Where it has none, the kernel may wake it hundreds of
  /// microseconds late. `clock`: the machine's unless given; outlives the pacer.
  TickPacer(double rate_Hz, bool wakesInTime, SessionClock* clock = nullptr) noexcept;

  /// Waits until tick `index` is due, asleep but for the last moment where cores are to spare (for the last millisecond
  /// where it would not wake in time), and returns the tick to do now: `index`, or a later one when more than a whole
  /// period went by unused. Ticks between are lost; they are never made up for in a burst.
  std::uint64_t waitFor(std::uint64_t index) const noexcept;

  /// The last tick that is overdue by a whole period: what comes at another's pace may be a little late.
  std::uint64_t passed() const noexcept;

  /// Time until tick `index` is due; negative once it is.
  double remaining_us(std::uint64_t index) const noexcept;

  /// Time that a query of tick `index` may take: until the next tick, less `reserve_us`, which is at most a fifth of a
  /// tick. At least 20 us, since 0 would mean as long as it takes.
  double budget_us(std::uint64_t index, double reserve_us) const noexcept;

 private:
  std::int64_t due_ns(std::uint64_t index) const noexcept;

  SessionClock& clock_;
  double period_ns_;
  std::int64_t spin_ns_;  ///< of each wait, at its end
  std::int64_t start_ns_;
};

}  // namespace palpate
