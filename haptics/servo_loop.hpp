// The servo loop: read the device, ask where the surface is, turn the answer into a force, write it, note it down.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "engine/core/contact_query.hpp"
#include "haptics/force_gate.hpp"
#include "haptics/force_law.hpp"
#include "haptics/haptic_device.hpp"
#include "haptics/passivity.hpp"
#include "haptics/tick_histogram.hpp"
#include "haptics/trace.hpp"

namespace palpate {

/// Is told of every tick at which the device answered, on the servo thread and as part of the tick: it waits for nobody
/// and allocates nothing.
class TickRecorder {
 public:
  virtual ~TickRecorder() = default;
  /// `device`: where it was, in its own unit.
  virtual void ticked(const TraceRow& row, const DVec3& device) noexcept = 0;
};

struct ServoOptions {
  double rate_Hz = 1000;
  double duration_s = 0;  ///< the number of ticks is duration times rate, rounded; at least one
  double begin_s = 0;     ///< the time of the first tick
  bool endless = false;  ///< against the wall clock until `stop`, whatever the duration; only a recorder sees the ticks
  bool realtime = false;  ///< the wall clock paces the ticks; otherwise they come as fast as they go
  double reserve_us =
      200;  ///< of a real-time tick, kept from the query for force and late waking; at most a fifth of it
  WorkspaceMap map;
  std::optional<PassivityMode> passivity;   ///< unless set: on for a device in a hand, off for a script
  const std::atomic<bool>* stop = nullptr;  ///< ends the session before its time when it becomes true
  /// No force while it is false; when it becomes true again, as at the start of a session: first a small demand, then
  /// the ramp. Unless set, forces are on.
  const std::atomic<bool>* forcesOn = nullptr;
  TickRecorder* recorder = nullptr;  ///< told of each tick, in virtual and in real time; outlives the loop
};

struct ServoResult {
  Trace trace;
  bool deviceFailed = false;
  bool queryLost = false;         ///< ended early: the query will never answer again
  std::string fault;              ///< the device's fault in words; empty unless it failed
  bool realtimePriority = false;  ///< the ticks ran under SCHED_FIFO
  TickHistogram step_us;          ///< from pose read to force ready
  TickHistogram late_us;          ///< from when a tick was due to its begin; empty in virtual time
  GateCounts withheld;
  std::optional<double> leastEnergy_mJ;  ///< that the surface had ever taken in; see Passivity
};

/// Called after each tick in virtual time only, outside of the tick: it may take long, allocate and throw.
using TickObserver = std::function<void(const TraceRow&)>;

/// Whatever happens, the last force the device gets is zero, also when a signal ends the program. A fault of the device
/// ends the session, with zero force from that tick on; a fault of the query means zero force at that tick, a row that
/// says so, and a ramp afterwards, or the end where the query is lost for good. Every force passes the ForceGate.
class ServoLoop {
 public:
  /// The device and the query must outlive the loop. The force is limited to the device's peak. Throws UsageError for a
  /// rate or duration out of range, and for a passivity controller on a device that yields to no force.
  ServoLoop(HapticDevice& device, ContactQuery& query, ForceLaw law, const ServoOptions& options);

  std::uint64_t plannedTicks() const { return plannedTicks_; }

  /// In virtual time tick i happens at exactly i / rate, and the same input gives the same trace. In real time no tick
  /// allocates or locks, and ticks whose time has passed by more than a period are left out and counted.
  ServoResult run(const TickObserver& observer = {});

 private:
  /// Fills the rows from the front and returns how many ticks were done.
  std::size_t play(const TickObserver& observer, ServoResult& result);
  enum class Tick { done, deviceFailed, queryLost };
  Tick tick(double time_s, double dt_s, double budget_us, TraceRow& row) noexcept;
  /// The force to write, with the device at `position` in its own unit.
  DVec3 forceFor(const DVec3& position, const Pose& pose, const Contact& contact, double dt_s) noexcept;
  /// Whether the device moved faster than a hand can since the last tick.
  bool hasJumped(const DVec3& position, double dt_s) noexcept;

  HapticDevice& device_;
  ContactQuery& query_;
  ForceLaw law_;
  ServoOptions options_;
  std::uint64_t plannedTicks_;
  DeviceLimits limits_;
  PassivityMode passivityMode_;
  Passivity passivity_;
  ForceGate gate_;
  std::optional<DVec3> lastPosition_;  ///< of the device, in its own unit
};

}  // namespace palpate
