// A stylus that is steered by pushing: a 3D mouse or the sticks of a gamepad set direction and speed, and a simulated
// Touch moves as a real one would in that hand.
#pragma once

#include "haptics/devices/hid_listener.hpp"
#include "haptics/devices/simulated_touch.hpp"

namespace palpate {

/// The hand has inertia and yields to the force. It presses as hard as the cap is pushed: the lead of the intended
/// position over the stylus is limited, more so when the cap is released. If the device is unplugged, the stylus stays
/// where it is, without force, and continues there later. At the start, too, the hand waits while forces ramp up. A
/// thread of its own listens; read() and write() never block.
class HidDevice final : public HapticDevice {
 public:
  /// `device`: from chooseHidSteering(). The stylus starts at `start_mm`. Throws Error if it cannot be opened.
  HidDevice(std::shared_ptr<HidTransport> transport, const HidInfo& device, const DVec3& start_mm, HidRemark remark);

  std::string_view name() const override { return name_; }
  /// Those of a Touch, but without its heat limit: there are no motors.
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override { return adrift_ || hand_.write(force_N); }
  void emergencyStop() noexcept override { hand_.emergencyStop(); }
  bool isStopped() const noexcept override { return hand_.isStopped(); }
  void resume() noexcept override { hand_.resume(); }
  std::string faultText() const override { return {}; }

 private:
  DVec3 intendedAt(double time_s) noexcept;

  std::string name_;
  HidListener listener_;
  DVec3 asked_mm_per_s_{0};
  bool adrift_ = true;  // no device holds the stylus, as before the first read
  DVec3 position_mm_, intended_mm_, speed_mm_per_s_{0};
  double intendedTime_s_ = 0, waitsUntil_s_ = 0;
  SimulatedTouch hand_;
};

}  // namespace palpate
