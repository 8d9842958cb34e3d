// The servo thread of a session.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "haptics/servo_mailbox.hpp"
#include "haptics/session/hand_source.hpp"
#include "haptics/session/tick_feed.hpp"

namespace palpate {

/// Options of a session that runs on its own thread. All pointees must outlive the run.
struct LiveRunOptions {
  double begin_s = 0;                           ///< the time of the first tick
  double rate_Hz = 0;                           ///< ticks per second; 0: as the configuration says
  std::shared_ptr<SteppedClock> clock;          ///< in place of the machine's (ServoOptions::clock)
  const std::atomic<bool>* forcesOn = nullptr;  ///< no force while it is false (ServoOptions::forcesOn)
  CustomForce law;                              ///< of the first hand, in place of spring and damper (ForceLaw)
};

/// Runs hands against the wall clock, with pauses, until it is destroyed. For one thread, except hasEnded() and core().
class LiveRun {
 public:
  /// What the servo thread does: plays the hands from a time on, until `stop` is true. The result says in `fault` why a
  /// device failed or the query was lost.
  using Play = std::function<ServoResult(std::span<const OpenHand> hands, const LiveRunOptions& options,
                                         const std::atomic<bool>& stop, TickRecorder& recorder)>;
  /// Starts. All hands must outlive it, and so must the mailbox of the loop, which is open while a thread runs.
  LiveRun(std::vector<OpenHand> hands, LiveRunOptions options, ServoMailbox& mailbox, Play play);
  ~LiveRun() { pause(); }
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  /// Waits for the tick in progress and ends the thread; the devices have no force then. False if there was none.
  bool pause();
  /// Starts a thread again, one tick after the last, unless one is running.
  void resume();
  /// The hand of a resting loop may move (ServoMailbox::wake()).
  void wake() noexcept { mailbox_.wake(); }
  /// Sets the hands of the next thread.
  void setHands(std::vector<OpenHand> hands) { hands_ = std::move(hands); }
  const std::vector<OpenHand>& hands() const { return hands_; }
  const std::shared_ptr<SteppedClock>& clock() const { return options_.clock; }
  /// A thread was started and not paused since; it may have ended.
  bool isStarted() const { return thread_.joinable(); }
  /// The time of the next thread's first tick.
  double next_s() const { return options_.begin_s; }
  /// Appends the ticks since the last call, as TickFeed does: a row for each hand. Ticks not taken for half a minute at
  /// 1 kHz are dropped.
  void take(std::vector<TraceRow>& rows);
  /// The thread has ended, because of a fault or a pause.
  bool hasEnded() const { return ended_; }
  /// Reason for which the thread ended by itself; empty if it did not. For use after its end.
  const std::string& fault() const { return fault_; }
  /// The device caused the fault.
  bool deviceFailed() const { return deviceFailed_; }
  /// CPU core of the last tick; negative before the first.
  int core() const { return feed_.core(); }

 private:
  void run(const LiveRunOptions& options);

  std::vector<OpenHand> hands_;
  LiveRunOptions options_;
  ServoMailbox& mailbox_;
  Play play_;
  TickFeed feed_;
  std::vector<TraceRow> before_;  // ticks of earlier threads that were not taken yet
  std::atomic<bool> stop_ = false, ended_ = false;
  std::string fault_;
  bool deviceFailed_ = false;
  std::jthread thread_;  // destroyed first
};

}  // namespace palpate
