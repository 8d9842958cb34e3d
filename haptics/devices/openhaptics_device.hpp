// A Geomagic Touch, Touch X, Phantom Omni, Desktop or Premium, through the vendor's OpenHaptics (HDAPI).
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "haptics/devices/haptic_device.hpp"
#include "haptics/devices/hdapi.hpp"

namespace palpate {

/// Who calls the ticks of a session.
enum class Scheduler {
  device,  ///< the driver's own servo thread, as the vendor means it
  own      ///< ours, at its own rate and priority
};

struct OpenHapticsOptions {
  std::string deviceName;  ///< as the vendor's setup program calls it; empty: the default device
  Scheduler scheduler = Scheduler::device;
  double rate_Hz = 1000;                        ///< of the driver's scheduler
  double calibrationPatience_s = 60;            ///< how long a person may take to calibrate
  std::function<void(const std::string&)> say;  ///< words for the person at the device
  const std::atomic<bool>* stop = nullptr;      ///< ends the wait for a calibration
};

/// Its current device is thread-local in the driver, so each thread that reads or writes makes it current first. A tick
/// is a frame: read() begins it, write() ends it.
class OpenHapticsDevice final : public HapticDevice {
 public:
  /// Loads the library, opens the device, calibrates it, starts the driver's scheduler. Throws Error with what is
  /// missing and what to do, in words.
  explicit OpenHapticsDevice(const OpenHapticsOptions& options);
  /// Force away, scheduler stopped, device given back.
  ~OpenHapticsDevice() override;

  std::string_view name() const override { return facts_.model; }
  DeviceLimits limits() const override { return limits_; }
  bool paces() const override { return options_.scheduler == Scheduler::device; }
  bool pace(double rate_Hz, const std::function<bool()>& tick) override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  /// Besides, gives the driver's thread a moment to send the zero, where it is not that thread that is being stopped.
  void emergencyStop() noexcept override;
  std::string faultText() const override;

  const HapticDeviceFacts& facts() const { return facts_; }
  /// Of the warmest motor, 0 cold to 1 hot.
  double motorTemperature() const { return temperature_.load(std::memory_order_relaxed); }

 private:
  /// For a person who has two of them: the name that it was asked for by, or its model.
  const std::string& calledName() const;
  void open();
  void close() noexcept;
  void learnFacts();
  void learnLimits();
  void calibrate();
  void testPosition();
  /// Throws Error when the driver has something to say that ends a session.
  void demandSuccess(const std::string& doing);
  /// The worst of what the driver has to say; on the servo thread.
  hdapi::Severity complaints() noexcept;
  bool isFrozen(const std::array<double, 3>& position_mm) noexcept;
  void watchMotors() noexcept;
  /// How the stylus is held; inside of a frame.
  DQuat turn() noexcept;
  void sendInFrame(const DVec3& force_N) noexcept;
  void fail(const char* what, const char* advice, std::uint32_t code = 0) noexcept;

  OpenHapticsOptions options_;
  VendorLibrary library_;
  hdapi::Api hd_;
  hdapi::Handle device_ = hdapi::kNoDevice;
  HapticDeviceFacts facts_;
  DeviceLimits limits_;
  bool tellsHeat_ = false, tellsTurn_ = false;

  // Of the thread that ticks.
  bool inFrame_ = false, hot_ = false;
  hdapi::Severity pending_ = hdapi::Severity::none;  // of the last write, for the next read
  std::uint32_t ticksToCheck_ = 0, pausedTicks_ = 0, frozenTicks_ = 0;
  std::atomic<double> temperature_ = 0;

  struct Fault {
    const char* what = nullptr;
    const char* advice = nullptr;
    std::uint32_t code = 0;
  };
  Fault first_;  // that ended the session; written once, before failed_
  std::atomic<bool> failed_ = false;

  std::atomic<bool> stopped_ = false, zeroSent_ = false;
  std::atomic<std::thread::id> servoThread_{};

  // What the driver's scheduler calls. It stands here because a driver that stalled may still call later.
  struct Calls {
    const std::function<bool()>* tick = nullptr;
    std::atomic<bool> abandoned = false, busy = false, ended = false;
    std::atomic<std::uint64_t> beats = 0;
  };
  std::shared_ptr<Calls> calls_;
};

}  // namespace palpate
