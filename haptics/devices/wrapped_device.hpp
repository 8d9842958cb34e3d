#pragma once

#include <memory>
#include <utility>

#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// Base for an extension of another device: passes on what it does not override.
class WrappedDevice : public HapticDevice {
 public:
  explicit WrappedDevice(std::unique_ptr<HapticDevice> device) : device_(std::move(device)) {}

  std::string_view name() const override { return device_->name(); }
  DeviceLimits limits() const override { return device_->limits(); }
  bool paces() const override { return device_->paces(); }
  bool pace(double rate_Hz, const std::function<bool()>& tick) override { return device_->pace(rate_Hz, tick); }
  DeviceState read(double time_s) noexcept override { return device_->read(time_s); }
  void feel(const std::optional<DVec3>& toProxy) noexcept override { device_->feel(toProxy); }
  bool write(const DVec3& force_N) noexcept override { return device_->write(force_N); }
  void emergencyStop() noexcept override { device_->emergencyStop(); }
  bool isStopped() const noexcept override { return device_->isStopped(); }
  void resume() noexcept override { device_->resume(); }
  std::string faultText() const override { return device_->faultText(); }

 private:
  std::unique_ptr<HapticDevice> device_;
};

}  // namespace palpate
