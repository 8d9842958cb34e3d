// The servo loop: read the device, ask where the surface is, turn the answer into a force, write it, note it down.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "engine/core/contact_query.hpp"
#include "haptics/force_law.hpp"
#include "haptics/haptic_device.hpp"
#include "haptics/trace.hpp"

namespace palpate {

struct ServoOptions {
  double rate_Hz = 1000;
  double duration_s = 0;    ///< the number of ticks is duration times rate, rounded; at least one
  bool realtime = false;    ///< the wall clock paces the ticks; otherwise they come as fast as they go
  double reserve_us = 200;  ///< of a real-time tick, kept from the query for the force and for waking up late
  WorkspaceMap map;
  const std::atomic<bool>* stop = nullptr;  ///< ends the session before its time when it becomes true
};

struct ServoResult {
  Trace trace;
  bool deviceFailed = false;
  std::string fault;              ///< the device's fault in words; empty unless it failed
  bool realtimePriority = false;  ///< the ticks ran under SCHED_FIFO
};

/// Called after each tick in virtual time only, outside of the tick: it may take long, allocate and throw.
using TickObserver = std::function<void(const TraceRow&)>;

/// Whatever happens, the last force the device gets is zero. A fault of the device ends the session, with zero force
/// from that tick on; a fault of the query means zero force at that tick and a row that says so.
class ServoLoop {
 public:
  /// The device and the query must outlive the loop. The force is limited to the device's peak. Throws UsageError for a
  /// rate or duration out of range.
  ServoLoop(HapticDevice& device, ContactQuery& query, ForceLaw law, const ServoOptions& options);

  std::uint64_t plannedTicks() const { return plannedTicks_; }

  /// In virtual time tick i happens at exactly i / rate, and the same input gives the same trace. In real time no tick
  /// allocates or locks, and ticks whose time has passed by more than a period are left out and counted.
  ServoResult run(const TickObserver& observer = {});

 private:
  /// Fills the rows from the front and returns how many ticks were done.
  std::size_t play(const TickObserver& observer, ServoResult& result);
  /// False when the device failed.
  bool tick(double time_s, double dt_s, double budget_us, TraceRow& row) noexcept;

  HapticDevice& device_;
  ContactQuery& query_;
  ForceLaw law_;
  ServoOptions options_;
  std::uint64_t plannedTicks_;
};

}  // namespace palpate
