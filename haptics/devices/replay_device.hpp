#pragma once

#include <vector>

#include "haptics/devices/haptic_device.hpp"
#include "haptics/session_log.hpp"

namespace palpate {

/// Plays the positions of a recorded session and yields to no force. It has the limits of the device that was there,
/// so that the servo loop treats its forces alike.
class ReplayDevice final : public HapticDevice {
 public:
  /// `ticks`: at least one, times ascending.
  ReplayDevice(std::vector<LoggedTick> ticks, const DeviceLimits& limits);

  std::string_view name() const override { return "replay"; }
  DeviceLimits limits() const override { return limits_; }
  /// Where the device was at the last tick up to `time_s`; at the first one before that.
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3&) noexcept override { return true; }
  void emergencyStop() noexcept override {}  // there is nothing that could pull
  std::string faultText() const override { return {}; }

 private:
  std::vector<LoggedTick> ticks_;
  const LoggedTick* last_ = nullptr;  // that was read
  DeviceLimits limits_;
};

}  // namespace palpate
