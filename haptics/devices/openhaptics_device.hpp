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

/// Which thread calls the ticks of a session.
enum class Scheduler {
  device,  ///< the driver's own servo thread, as the vendor intends
  own      ///< palpate's, at its own rate and priority
};

struct OpenHapticsOptions {
  std::string deviceName;  ///< as in the vendor's setup program; empty: the default device
  Scheduler scheduler = Scheduler::device;
  double rate_Hz = 1000;                        ///< of the driver's scheduler
  double calibrationPatience_s = 60;            ///< timeout for a manual calibration
  std::function<void(const std::string&)> say;  ///< messages for the user
  const std::atomic<bool>* stop = nullptr;      ///< ends the wait for a calibration
};

/// The driver's current device is thread-local, so each thread that reads or writes makes it current first. A tick is a
/// frame: read() begins it, write() ends it.
class OpenHapticsDevice final : public HapticDevice {
 public:
  /// Loads the library, opens and calibrates the device, starts the driver's scheduler. Throws Error that says what is
  /// missing and what to do.
  explicit OpenHapticsDevice(const OpenHapticsOptions& options);
  /// Removes the force, stops the scheduler, closes the device.
  ~OpenHapticsDevice() override;

  std::string_view name() const override { return facts_.model; }
  DeviceLimits limits() const override { return limits_; }
  bool paces() const override { return options_.scheduler == Scheduler::device; }
  bool pace(double rate_Hz, const std::function<bool()>& tick) override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  /// Also gives the driver's thread a moment to send the zero, unless that thread is the one being stopped.
  void emergencyStop() noexcept override;
  bool isStopped() const noexcept override { return stopped_.load(); }
  void resume() noexcept override;
  std::string faultText() const override;

  const HapticDeviceFacts& facts() const { return facts_; }
  /// Temperature of the warmest motor, 0 cold to 1 hot.
  double motorTemperature() const { return temperature_.load(std::memory_order_relaxed); }

 private:
  /// Tells two devices apart: the name that was requested, or the model.
  const std::string& calledName() const;
  void open();
  void close() noexcept;
  void learnFacts();
  void learnLimits();
  void calibrate();
  /// Outside of ticks, during a session: tells that the calibration is lost, or that it is back, and renews it.
  void tendCalibration();
  void testPosition();
  /// Throws Error if the driver reports an error that ends a session.
  void demandSuccess(const std::string& doing);
  /// The most severe error that the driver reports; on the servo thread.
  hdapi::Severity complaints() noexcept;
  bool isFrozen(const std::array<double, 3>& position_mm) noexcept;
  void watchMotors() noexcept;
  /// Orientation of the stylus; inside of a frame.
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

  // Used by the thread that ticks.
  bool inFrame_ = false, hot_ = false;
  hdapi::Severity pending_ = hdapi::Severity::none;  // of the last write, for the next read
  std::uint32_t ticksToCheck_ = 0, pausedTicks_ = 0, frozenTicks_ = 0, uncalibratedTicks_ = 0;
  std::atomic<double> temperature_ = 0;
  std::atomic<hdapi::Enum> calibration_ = hdapi::kCalibrated;  // of the last tick
  bool tellsLost_ = false;                                     // used by the thread in pace()

  struct Fault {
    const char* what = nullptr;
    const char* advice = nullptr;
    std::uint32_t code = 0;
  };
  Fault first_;  // the one that ended the session; written once, before failed_
  std::atomic<bool> failed_ = false;

  std::atomic<bool> stopped_ = false, zeroSent_ = false;
  std::atomic<std::thread::id> servoThread_{};

  // Called by the driver's scheduler.
  struct Calls {
    const std::function<bool()>* tick = nullptr;
    std::atomic<bool> abandoned = false, busy = false, ended = false;
    std::atomic<std::uint64_t> beats = 0;
  };
  std::shared_ptr<Calls> calls_;
  /// Until the program ends: a driver that has stalled may still call later.
  static void keepForDriver(std::shared_ptr<Calls> calls);
};

}  // namespace palpate
