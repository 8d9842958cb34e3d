// A Haply Inverse3 with its grip, through the Haply service of this machine, which needs no SDK.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "engine/core/latest_value.hpp"
#include "haptics/devices/haply_force_watch.hpp"
#include "haptics/devices/haply_service.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/devices/report_queue.hpp"
#include "haptics/session_clock.hpp"

namespace palpate {

struct HaplyOptions {
  std::string serial;                           ///< empty: the only device
  bool shares = false;                          ///< takes a device that another program uses, whose forces add to these
  std::function<void(const std::string&)> say;  ///< messages for the user, also from a thread of the device
  /// Replaces the machine's clock, and must outlive the device. The service paces the exchange then.
  SessionClock* clock = nullptr;
};

/// A thread of its own exchanges messages with the service, at most 4000 times a second: each tells the newest force
/// and is answered with the newest state. read() and write() exchange both with that thread and never wait. The
/// thread itself takes the force away as soon as a state shows a fault, several in a row show another program's force,
/// none comes for 20 ms, or no force was written for 20 ms; it stays away for so long that ForceGate then waits for
/// free space. Another thread says why, so that no listener delays the zero.
class HaplyDevice final : public HapticDevice {
 public:
  /// Throws Error that says what is missing and what to do.
  explicit HaplyDevice(const HaplyOptions& options);
  /// Tells the service a force of zero, and closes.
  ~HaplyDevice() override;

  std::string_view name() const override { return facts_.model; }
  DeviceLimits limits() const override { return limits_; }
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  /// Also gives the exchange a moment to send the zero.
  void emergencyStop() noexcept override;
  bool isStopped() const noexcept override { return stopped_.load(); }
  void resume() noexcept override;
  std::string faultText() const override;

  const HapticDeviceFacts& facts() const { return facts_; }

 private:
  void choose();
  std::int64_t now_ns() const noexcept { return clock_.now_ns(); }
  void say(const std::string& sentence);
  void exchange(const std::stop_token& stop);
  /// False at the end of the session.
  bool exchangeOnce(std::string& message);
  void hearEvents();
  void take(const std::string& message, std::int64_t now_ns);
  void accept(const std::string& message, std::int64_t now_ns);
  void enter(haply::Trouble trouble, std::int64_t now_ns);
  void tell(haply::Trouble trouble);
  void publish(std::int64_t now_ns);
  DVec3 permitted_N(std::int64_t now_ns) noexcept;
  bool send(const DVec3& force_N);

  HaplyOptions options_;
  SessionClock& clock_;
  std::unique_ptr<HaplyService> service_;
  haply::Choice choice_;
  bool values_ = false;  ///< spelling of the force
  HapticDeviceFacts facts_;
  DeviceLimits limits_;

  // Used by the thread of the exchange.
  haply::State state_;
  haply::ForceWatch forces_;
  bool introduced_ = false, safetyHolds_ = false;
  int unanswered_ = 0;
  haply::Trouble told_ = haply::Trouble::none;
  std::int64_t good_ns_ = 0, sent_ns_ = 0, quietUntil_ns_ = 0;

  /// For the thread that ticks.
  struct Shown {
    DVec3 position_mm{0};
    DQuat turn{1, 0, 0, 0};
    std::uint32_t buttons = 0;
    bool rendersForce = false;
    std::int64_t time_ns = 0;  ///< of the state
  };
  LatestValue<Shown> shown_;
  Shown last_;  // used by the thread that ticks
  struct Wanted {
    DVec3 force_N{0};
    std::int64_t time_ns = 0;
  };
  LatestValue<Wanted> wanted_;
  Wanted newest_;  // used by the thread of the exchange

  std::atomic<haply::Trouble> fault_ = haply::Trouble::none;  ///< that ended the session
  std::atomic<bool> stopped_ = false, zeroSent_ = false;
  ReportQueue<haply::Trouble> reports_;
  std::jthread exchange_;  // destroyed first
};

}  // namespace palpate
