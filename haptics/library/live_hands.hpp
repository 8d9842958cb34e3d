// The hands of a live session: their devices, the servo thread, and the ticks not read yet.
#pragma once

#include <palpate/palpate.h>

#include <atomic>
#include <optional>
#include <vector>

#include "haptics/library/contact_events.hpp"
#include "haptics/library/force_function.hpp"
#include "haptics/session/hand_source.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

pp_tick tickOf(const TraceRow& row);

class LiveHands {
 public:
  struct Surroundings {
    Session& session;
    Log& log;
    const std::atomic<bool>& forcesOn;
    CustomForce law;  ///< used unless the options have a law
  };
  /// Opens the devices, one for each hand of the session, without starting ticks. Throws Error.
  LiveHands(const pp_live_options& options, const Surroundings& with);
  ~LiveHands() { stop(); }
  LiveHands(const LiveHands&) = delete;
  LiveHands& operator=(const LiveHands&) = delete;

  double rate_Hz() const { return rate_Hz_; }
  bool hasLaw() const { return hasLaw_; }
  std::optional<std::string> takeLawFault() { return law_.takeFault(); }
  OpenHand first() const { return hands_.front().hand(); }
  /// Starts the session's servo thread.
  void start();
  bool isRunning() const { return run_ && !run_->hasEnded(); }
  void stop();
  /// Reads rows of whole ticks, up to `capacity`, notifies `events` of them, and returns their number. Throws
  /// DeviceError or GpuError if the thread has ended because of a fault and no ticks are left.
  std::uint64_t take(const pp_live_rows& rows, ContactEvents& events);
  std::uint64_t ticks() const { return ticks_; }
  std::uint64_t missed() const { return missed_; }

 private:
  Surroundings with_;
  double rate_Hz_;
  ForceFunction law_;
  std::vector<HandSource> hands_;
  std::vector<TraceRow> waiting_;  // rows from next_ on are not read yet
  std::size_t next_ = 0;
  std::uint64_t ticks_ = 0, missed_ = 0;
  std::optional<double> lastTime_s_;
  bool stopped_ = false, hasLaw_ = false;
  std::shared_ptr<LiveRun> run_;  // the session's, which may be replaced; destroyed first
};

}  // namespace palpate::library
