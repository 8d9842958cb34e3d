#pragma once

#include <atomic>
#include <vector>

#include "haptics/devices/haptic_device.hpp"
#include "haptics/session_log.hpp"

namespace palpate {

/// Plays the positions of a recorded session, and does not yield to forces. It has the limits of the recorded device,
/// so that the servo loop treats its forces alike.
class ReplayDevice final : public HapticDevice {
 public:
  /// `ticks`: at least one, in ascending order of time.
  ReplayDevice(std::vector<LoggedTick> ticks, const DeviceLimits& limits);

  std::string_view name() const override { return "replay"; }
  DeviceLimits limits() const override { return limits_; }
  /// State of the last tick up to `time_s`; before the first tick, that of the first.
  DeviceState read(double time_s) noexcept override;
  /// Whether forces were on at the tick that was read last, for ServoOptions::forcesOn.
  const std::atomic<bool>& forcesOn() const { return forcesOn_; }
  bool write(const DVec3&) noexcept override { return true; }
  void emergencyStop() noexcept override {}  // it has no motors
  std::string faultText() const override { return {}; }

 private:
  std::vector<LoggedTick> ticks_;
  const LoggedTick* last_ = nullptr;  // the last one that was read
  std::atomic<bool> forcesOn_ = true;
  DeviceLimits limits_;
};

}  // namespace palpate
