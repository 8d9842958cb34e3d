// The hands of a live session: their devices, its servo thread, and the ticks that nobody has taken yet.
#pragma once

#include <palpate/palpate.h>

#include <atomic>
#include <optional>
#include <vector>

#include "haptics/library/force_function.hpp"
#include "haptics/session/hand_source.hpp"
#include "haptics/session/servo_thread.hpp"

namespace palpate::library {

pp_tick tickOf(const TraceRow& row);

class LiveHands {
 public:
  struct Surroundings {
    Session& session;
    Log& log;
    const std::atomic<bool>& forcesOn;
    CustomForce law;  ///< unless the options have one
  };
  /// Opens the devices, one for each hand of the session, and gets ready. Throws Error.
  LiveHands(const pp_live_options& options, const Surroundings& with);

  double rate_Hz() const { return rate_Hz_; }
  bool hasLaw() const { return hasLaw_; }
  OpenHand first() const { return hands_.front().hand(); }
  /// Begins.
  void start();
  bool isRunning() const { return thread_ && !thread_->hasEnded(); }
  void stop();
  /// As many rows as there is room for, of whole ticks. Throws DeviceError or GpuError where the thread has ended by
  /// itself and no ticks are left.
  std::uint64_t take(pp_tick* ticks, std::uint64_t capacity);
  std::uint64_t ticks() const { return ticks_; }
  std::uint64_t missed() const { return missed_; }

 private:
  Surroundings with_;
  double rate_Hz_;
  ForceFunction law_;
  std::vector<HandSource> hands_;
  std::vector<TraceRow> waiting_;  // of these those from next_ on
  std::size_t next_ = 0;
  std::uint64_t ticks_ = 0, missed_ = 0;
  std::optional<double> lastTime_s_;
  bool stopped_ = false, hasLaw_ = false;
  std::optional<ServoThread> thread_;  // goes first
};

}  // namespace palpate::library
