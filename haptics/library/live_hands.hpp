// The hands of a live session: their devices, the servo thread, and the ticks not read yet.
#pragma once

#include <palpate/palpate.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptics/force_law.hpp"
#include "haptics/session/hand_source.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

/// A force law of the program, as a C function or loaded from a library.
class ForceFunction {
 public:
  ForceFunction() = default;
  /// `library`: "libmine.so:function", instead of `law`; empty: none. Throws UsageError, and Error with the loader's
  /// message.
  ForceFunction(pp_force_law law, void* user, const std::string& library, double mm_per_unit);

  /// How often the law has given a force that is not a finite number since the last call, in words.
  std::optional<std::string> takeFault();

  /// Valid while this object is not moved; empty if the program has no law.
  CustomForce custom() { return law_ ? CustomForce{&call, this} : CustomForce{}; }

 private:
  static DVec3 call(void* user, const Contact& contact, const Pose& pose, double dt_s, const DVec3& usual_N) noexcept;

  pp_force_law law_ = nullptr;
  void* user_ = nullptr;
  double mm_per_unit_ = 1;
  struct Faults {
    std::atomic<std::uint64_t> count = 0;
    std::atomic<double> first_s = 0;  // of those since the last call
  };
  std::unique_ptr<Faults> faults_ = std::make_unique<Faults>();
};

/// The answer to a pose, as the program receives it.
pp_contact contactOf(const Contact& contact, const Pose& pose, const DVec3& force_N, double mm_per_unit);

/// Beginning and end of contacts, for the program's function.
/// Calls the program's function where a hand comes into contact or leaves it. Allocates nothing. Throws what the
/// function throws.
class ContactEvents {
 public:
  /// From the next tick on; null: no function.
  void listen(pp_contact_function function, void* user);
  /// One tick of a hand.
  void felt(std::size_t hand, double t_s, const pp_contact& contact);
  void felt(std::size_t hand, const pp_tick& tick);
  /// Ends all contacts, at the time of the last tick.
  void endAll();

 private:
  void tell(std::size_t hand, bool touches, const pp_contact_event& now);

  pp_contact_function function_ = nullptr;
  void* user_ = nullptr;
  double last_s_ = 0;
  std::array<pp_contact_event, PP_MAX_HANDS> last_{};  // last tick in contact; begins is 1 while that lasts
};

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
