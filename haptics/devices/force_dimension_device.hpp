// A Force Dimension omega, delta or sigma, or a Novint Falcon, through the vendor's libdhd.
#pragma once

#include <array>
#include <atomic>

#include "haptics/devices/dhd.hpp"
#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// Each call communicates with the device over its cable, so the ticks run on palpate's thread at its rate. The
/// device's own watchdog removes the force if none was written for some ms, even after a crash of the program.
class ForceDimensionDevice final : public HapticDevice {
 public:
  /// `index`: among the connected devices, from 0. Throws Error that says what is missing and what to do.
  explicit ForceDimensionDevice(int index = 0);
  ~ForceDimensionDevice() override;

  std::string_view name() const override { return facts_.model; }
  DeviceLimits limits() const override { return limits_; }
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  void emergencyStop() noexcept override { stopped_.store(true); }
  bool isStopped() const noexcept override { return stopped_.load(); }
  void resume() noexcept override { stopped_.store(false); }
  std::string faultText() const override;

  const HapticDeviceFacts& facts() const { return facts_; }

 private:
  std::string lastError() const;
  /// `why`: in words, or null.
  void fail(const char* why) noexcept;

  VendorLibrary library_;
  dhd::Api dhd_;
  char device_ = -1;
  HapticDeviceFacts facts_;
  DeviceLimits limits_;
  std::array<char, 128> fault_{};  // the driver's text at the first failure
  std::atomic<bool> failed_ = false, stopped_ = false;
};

}  // namespace palpate
