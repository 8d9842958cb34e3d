// The servo loop: read the devices, ask where the surface is, turn the answers into forces, write them, note them down.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "haptics/hand.hpp"
#include "haptics/information_age.hpp"
#include "haptics/scheduling_statistics.hpp"
#include "haptics/tick_histogram.hpp"
#include "haptics/tick_pacer.hpp"
#include "haptics/trace.hpp"

namespace palpate {

/// Is notified of every tick at which the devices answered, on the servo thread and as part of the tick: it waits for
/// nobody and allocates nothing.
class TickRecorder {
 public:
  virtual ~TickRecorder() = default;
  /// Of the hands after the first, in order, before ticked() of the same tick.
  virtual void tickedToo(std::size_t /*hand*/, const TraceRow& /*row*/) noexcept {}
  /// Of the first hand.
  virtual void ticked(const TraceRow& row, const DeviceState& device) noexcept = 0;
};

struct ServoOptions {
  double rate_Hz = 1000;
  double duration_s = 0;  ///< the number of ticks is duration times rate, rounded; at least one
  double begin_s = 0;     ///< the time of the first tick
  bool endless = false;  ///< against the wall clock until `stop`, whatever the duration; only a recorder sees the ticks
  bool realtime = false;  ///< the wall clock paces the ticks; otherwise they come as fast as they go
  /// In place of the machine's clock in real time. It stands still while a tick runs, so that a query takes as long as
  /// it likes and no tick is late, whoever paces them; outlives the loop.
  SteppedClock* clock = nullptr;
  double reserve_us =
      200;  ///< of a real-time tick, kept from the query for force and late waking; at most a fifth of it
  const std::atomic<bool>* stop = nullptr;  ///< ends the session before its time when it becomes true
  /// No force while it is false; when it becomes true again, as at the start of a session: first a small demand, then
  /// the ramp. Unless set, forces are on.
  const std::atomic<bool>* forcesOn = nullptr;
  /// How old what is felt is, where others change it: it bears less and less of a force. Unless set, it is always true.
  const InformationAge* known = nullptr;
  TickRecorder* recorder = nullptr;  ///< notified of each tick, in virtual and in real time; outlives the loop
};

/// A hand that a session begins with: the device that it holds, which outlives the session, and how its force is made.
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
  bool queryLost = false;           ///< ended early: the query will never answer again
  std::string fault;                ///< of the device that failed, in words; empty unless one did
  bool realtimePriority = false;    ///< the ticks ran under SCHED_FIFO
  bool pacedByDevice = false;       ///< on the device's own thread
  TickHistogram step_us;            ///< from pose read to force ready
  TickHistogram late_us;            ///< from when a tick was due to its begin; empty in virtual time
  SchedulingStatistics scheduling;  ///< of the servo thread; nothing in virtual time and at the device's pace

  /// Of the first hand.
  const Trace& trace() const { return hands.front().trace; }
  const HandCounts& counts() const { return hands.front().counts; }
};

/// Called after each tick in virtual time only, outside of the tick: it may take long, allocate and throw.
using TickObserver = std::function<void(const TraceRow&)>;

/// Whatever happens, the last force the device gets is zero, also when a signal ends the program. A fault of the device
/// ends the session, with zero force from that tick on; a fault of the query means zero force at that tick, a row that
/// says so, and a ramp afterwards, or the end where the query is lost for good. Every force passes the ForceGate. All
/// hands are asked for at once; a fault of one device takes all forces away. The first hand's device may pace the
/// ticks.
class ServoLoop {
 public:
  /// Devices and query must outlive the loop. Throws UsageError for a rate or duration out of range, for another number
  /// of hands than the query answers, for a device other than the first that would pace the ticks, and as Hand does.
  ServoLoop(ContactQuery& query, const std::vector<SessionHand>& hands, const ServoOptions& options);
  /// Of one hand.
  ServoLoop(HapticDevice& device, ContactQuery& query, ForceLaw law, const ServoOptions& options,
            const HandOptions& hand = {});

  std::uint64_t plannedTicks() const { return plannedTicks_; }

  /// In virtual time tick i happens at exactly i / rate, and the same input gives the same trace. In real time no tick
  /// allocates or locks, and ticks whose time has passed by more than a period are left out and counted.
  ServoResult run(const TickObserver& observer = {});

 private:
  /// Fills the rows from the front and returns how many ticks were done.
  std::size_t play(const TickObserver& observer, ServoResult& result);
  std::size_t playAtOnce(const TickObserver& observer, ServoResult& result);
  std::size_t playByClock(ServoResult& result);
  std::size_t playByDevice(ServoResult& result);
  bool isOver(std::uint64_t index) const noexcept;
  double budgetOf(const TickPacer& pacer, std::uint64_t index) const noexcept;
  struct Progress {
    std::size_t done = 0;
    std::optional<double> lastTime_s;
  };
  /// Does the tick `index`; false when it was the last.
  bool next(std::uint64_t index, double budget_us, Progress& progress, ServoResult& result) noexcept;
  enum class Tick { done, deviceFailed, queryLost };
  /// `place`: of the rows to fill.
  Tick tick(double time_s, double dt_s, double budget_us, std::size_t place, ServoResult& result) noexcept;
  TickConditions conditionsNow() const noexcept;
  /// False when a device failed; then no device has a force.
  bool readAll(double time_s) noexcept;
  bool writeAll() noexcept;
  bool failedAt(const Hand& hand) noexcept;

  ContactQuery& query_;
  ServoOptions options_;
  std::uint64_t plannedTicks_;
  std::vector<Hand> hands_;
  std::vector<Pose> poses_;       ///< of the present tick, one for each hand
  const Hand* failed_ = nullptr;  ///< the first one whose device did
};

}  // namespace palpate
