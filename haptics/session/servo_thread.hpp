// A session that runs on a servo thread of its own, for a program that reads its ticks in blocks.
#pragma once

#include <atomic>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "haptics/session/session.hpp"
#include "haptics/session/tick_feed.hpp"

namespace palpate {

/// Runs against the wall clock until it is stopped or destroyed. All methods are for one thread, which also takes the
/// edits (EditRelay::catchUp()).
class ServoThread {
 public:
  struct Options {
    const std::atomic<bool>* forcesOn = nullptr;  ///< no force while it is false (RunOptions::forcesOn)
    CustomForce law;                              ///< of the first hand, in place of spring and damper
    double rate_Hz = 0;                           ///< 0: as the session is configured
  };
  /// Begins at once. Session, devices and all pointees must outlive it, and nothing else runs the session meanwhile.
  ServoThread(Session& session, std::span<const OpenHand> hands, const Options& options);
  ~ServoThread() { stop(); }
  ServoThread(const ServoThread&) = delete;
  ServoThread& operator=(const ServoThread&) = delete;

  /// Appends the ticks since the last call, as TickFeed does: a row for each hand. Ticks not taken for half a minute at
  /// 1 kHz are dropped.
  void take(std::vector<TraceRow>& rows) { feed_.take(rows); }
  /// Waits for the tick in progress; the device has no force afterwards.
  void stop();
  /// Because of a fault, or stopped.
  bool hasEnded() const { return ended_; }
  /// Reason of a fault that has ended it; empty: none. For use after the end.
  const std::string& fault() const { return fault_; }
  /// The device caused the fault.
  bool deviceFailed() const { return deviceFailed_; }

 private:
  void run(Session& session, const std::vector<OpenHand>& hands, const Options& options);

  TickFeed feed_;
  std::atomic<bool> stop_ = false, ended_ = false;
  std::string fault_;
  bool deviceFailed_ = false;
  std::jthread thread_;  // destroyed first
};

}  // namespace palpate
