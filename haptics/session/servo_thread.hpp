// A session that runs on a servo thread of its own, for a program that takes its ticks in blocks.
#pragma once

#include <atomic>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "haptics/session/session.hpp"
#include "haptics/session/tick_feed.hpp"

namespace palpate {

/// Against the wall clock and without end, until it is stopped or goes. All but the ticks is for one thread, which
/// takes in what they do to the points (EditRelay::catchUp()), too.
class ServoThread {
 public:
  struct Options {
    const std::atomic<bool>* forcesOn = nullptr;  ///< no force while it is false (RunOptions::forcesOn)
    CustomForce law;                              ///< the first hand's, in place of spring and damper
    double rate_Hz = 0;                           ///< 0: as the session is configured
  };
  /// Begins at once. Session, devices and what is pointed to outlive it, and nothing else runs the session meanwhile.
  ServoThread(Session& session, std::span<const OpenHand> hands, const Options& options);
  ~ServoThread() { stop(); }
  ServoThread(const ServoThread&) = delete;
  ServoThread& operator=(const ServoThread&) = delete;

  /// Appends the ticks since the last call, as TickFeed does: a row for each hand. What is not taken for half a minute
  /// at 1 kHz is left out.
  void take(std::vector<TraceRow>& rows) { feed_.take(rows); }
  /// Waits for the tick under way; the device has no force then.
  void stop();
  /// By itself, or stopped.
  bool hasEnded() const { return ended_; }
  /// Why it has ended by itself, in words; empty where it did not. Once it has ended.
  const std::string& fault() const { return fault_; }
  /// That it was the device.
  bool deviceFailed() const { return deviceFailed_; }

 private:
  void run(Session& session, const std::vector<OpenHand>& hands, const Options& options);

  TickFeed feed_;
  std::atomic<bool> stop_ = false, ended_ = false;
  std::string fault_;
  bool deviceFailed_ = false;
  std::jthread thread_;  // goes first
};

}  // namespace palpate
