// The servo loop: read the devices, query the surface, turn the answers into forces, write and record them.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "haptics/hand.hpp"
#include "haptics/information_age.hpp"
#include "haptics/scheduling_statistics.hpp"
#include "haptics/servo_mailbox.hpp"
#include "haptics/state_numbers.hpp"
#include "haptics/tick_histogram.hpp"
#include "haptics/tick_pacer.hpp"
#include "haptics/trace.hpp"

namespace palpate {

/// Notified of every tick at which the devices answered, on the servo thread and as part of the tick: must neither
/// block nor allocate.
class TickRecorder {
 public:
  virtual ~TickRecorder() = default;
  /// For the hands after the first, in order, before ticked() of the same tick.
  virtual void tickedToo(std::size_t /*hand*/, const TraceRow& /*row*/) noexcept {}
  /// For the first hand.
  virtual void ticked(const TraceRow& row, const DeviceState& device) noexcept = 0;
};

struct ServoOptions {
  double rate_Hz = 1000;
  double duration_s = 0;  ///< the number of ticks is duration times rate, rounded; at least one
  double begin_s = 0;     ///< the time of the first tick
  bool endless = false;   ///< in real time until `stop`, whatever the duration; only a recorder sees the ticks
  bool realtime = false;  ///< the wall clock paces the ticks; otherwise they run as fast as possible
  /// Replaces the machine's clock in real time. It is constant during a tick, so that a query may take any time and no
  /// tick is late, at any pace; must outlive the loop.
  SteppedClock* clock = nullptr;
  double reserve_us =
      200;  ///< of a real-time tick, kept from the query for the force and for late waking; at most a fifth of the tick
  const std::atomic<bool>* stop = nullptr;  ///< ends the session early when it becomes true
  /// No force while it is false; when it becomes true again, as at the start of a session: first a small demand, then
  /// the ramp. Null: forces are on.
  const std::atomic<bool>* forcesOn = nullptr;
  /// Age of the information about the surface, if others change it: reduces the force. Null: always current.
  const InformationAge* known = nullptr;
  TickRecorder* recorder = nullptr;  ///< notified of each tick, in virtual and in real time; must outlive the loop
  ServoMailbox* mailbox = nullptr;   ///< commands, in real time; open, and closed by the caller afterwards
  /// Continues as the loop whose saveState() this is: with the numbers of its ticks and the state of its hands.
  std::span<const double> resume;
};

/// A hand at the start of a session: its device, which must outlive the session, and how its force is computed.
struct SessionHand {
  HapticDevice& device;
  ForceLaw law;
  HandOptions options = {};
};

struct HandResult {
  Trace trace;  ///< all hands have the same ticks
  HandCounts counts;
};

struct ServoResult {
  std::vector<HandResult> hands;
  bool deviceFailed = false;
  bool queryLost = false;           ///< ended early: the query is lost for good
  std::string fault;                ///< of the failed device, in words; empty if none failed
  bool realtimePriority = false;    ///< the ticks ran under SCHED_FIFO
  bool pacedByDevice = false;       ///< on the device's own thread
  TickHistogram step_us;            ///< from pose read to force computed
  TickHistogram late_us;            ///< from the due time of a tick to its start; empty in virtual time
  SchedulingStatistics scheduling;  ///< of the servo thread; empty in virtual time and at the device's pace

  /// Trace and counts of the first hand.
  const Trace& trace() const { return hands.front().trace; }
  const HandCounts& counts() const { return hands.front().counts; }
};

/// Called after each tick in virtual time only, outside the tick: it may take long, allocate and throw.
using TickObserver = std::function<void(const TraceRow&)>;
/// The same before each tick, with the number of ticks before it.
using TickHook = std::function<void(std::uint64_t)>;

/// The last force that a device gets is always zero, also when a signal ends the program. A fault of a device ends the
/// session, with zero force from that tick on. A fault of the query means zero force at that tick, a row that says so,
/// and a ramp afterwards, or the end if the query is lost for good. Every force passes the ForceGate. All hands are
/// queried at once; a fault of one device removes all forces. The first hand's device may pace the ticks.
class ServoLoop {
 public:
  /// Devices and query must outlive the loop. Throws UsageError for a rate or duration out of range, for a number of
  /// hands other than the query's, for a device other than the first that would pace the ticks, and as Hand does.
  ServoLoop(ContactQuery& query, const std::vector<SessionHand>& hands, const ServoOptions& options);
  /// With one hand.
  ServoLoop(HapticDevice& device, ContactQuery& query, ForceLaw law, const ServoOptions& options,
            const HandOptions& hand = {});

  std::uint64_t plannedTicks() const { return plannedTicks_; }

  /// In virtual time tick i is at exactly i / rate, and the same input gives the same trace. In real time no tick
  /// allocates or locks, and ticks that are late by more than a period are skipped and counted.
  ServoResult run(const TickObserver& observer = {}, const TickHook& before = {});

  // For commands: on the thread that ticks, between two ticks.

  /// Replaces the options of the force law of all hands.
  void setForce(const ForceOptions& options) noexcept;
  /// Time of the next tick, if none is missed.
  double next_s() const noexcept { return time_s(next()); }
  /// Numbers of saveState().
  std::size_t stateSize() noexcept;
  /// What the next tick needs from the ticks before it, for ServoOptions::resume. Allocates nothing.
  void saveState(std::span<double> numbers) noexcept;

 private:
  /// Fills the rows from the front and returns the number of ticks done.
  std::size_t play(const TickObserver& observer, const TickHook& before, ServoResult& result);
  std::size_t playAtOnce(const TickObserver& observer, const TickHook& before, ServoResult& result);
  std::size_t playByClock(ServoResult& result);
  std::size_t playByDevice(ServoResult& result);
  bool isOver(std::uint64_t index) const noexcept;
  /// Sleeps once the only hand has rested for a while, where time is the number of ticks (countsTicks), so that no
  /// tick is missed. Returns whether it has slept.
  bool rest() noexcept;
  double budgetOf(const TickPacer& pacer, std::uint64_t index) const noexcept;
  struct Progress {
    std::size_t done = 0;
    std::optional<std::uint64_t> lastIndex;  // of the ticks that count
    std::uint64_t next = 0, missed = 0;      // index after the last tick, and ticks left out since the last row
  };
  /// Runs the tick that is due, after the commands that wait; false if it was the last.
  bool next(std::uint64_t due, double budget_us, ServoResult& result) noexcept;
  std::uint64_t next() const noexcept { return first_ + (countsTicks_ ? progress_.done : progress_.next); }
  double time_s(std::uint64_t index) const noexcept { return begin_s_ + static_cast<double>(index) / options_.rate_Hz; }
  /// Sets or reads begin_s_ and the number of the next tick, and the state of the hands.
  void visitState(StateNumbers& visit) noexcept;
  enum class Tick { done, waits, deviceFailed, queryLost };
  /// `place`: index of the rows to fill.
  Tick tick(double time_s, double dt_s, double budget_us, std::size_t place, std::uint64_t missed,
            ServoResult& result) noexcept;
  /// False if a device failed; then no device has a force.
  bool readAll(double time_s) noexcept;
  bool writeAll() noexcept;
  bool failedAt(const Hand& hand) noexcept;

  ContactQuery& query_;
  ServoOptions options_;
  std::uint64_t plannedTicks_;
  std::vector<Hand> hands_;
  bool countsTicks_ = false;      ///< DeviceLimits::countsTicks
  std::vector<Pose> poses_;       ///< of the current tick, one for each hand
  std::uint32_t wakes_ = 0;       ///< ServoMailbox::wakes() before the last tick
  double rested_s_ = 0;           ///< since then
  const Hand* failed_ = nullptr;  ///< the first one whose device failed
  Progress progress_;
  double begin_s_ = 0;       ///< the time of tick 0
  std::uint64_t first_ = 0;  ///< the number of the first tick
};

}  // namespace palpate
