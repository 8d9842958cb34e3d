// Any device, with a gamepad beside it that rumbles at each contact.
#pragma once

#include "haptics/devices/rumble.hpp"
#include "haptics/devices/wrapped_device.hpp"

namespace palpate {

class RumblingDevice final : public WrappedDevice {
 public:
  RumblingDevice(std::unique_ptr<HapticDevice> device, std::unique_ptr<Rumble> rumble)
      : WrappedDevice(std::move(device)), rumble_(std::move(rumble)) {}

  DeviceState read(double time_s) noexcept override {
    const DeviceState state = WrappedDevice::read(time_s);
    rendersForce_ = state.ok && state.rendersForce;
    return state;
  }
  bool write(const DVec3& force_N) noexcept override {
    const bool written = WrappedDevice::write(force_N);
    rumble_->setForce(written && rendersForce_ ? force_N : DVec3(0));
    return written;
  }
  void emergencyStop() noexcept override {
    WrappedDevice::emergencyStop();
    rumble_->stop();
  }
  void resume() noexcept override {
    rumble_->resume();
    WrappedDevice::resume();
  }

 private:
  std::unique_ptr<Rumble> rumble_;
  bool rendersForce_ = true;
};

}  // namespace palpate
