// A stylus that is steered by pushing: a 3D mouse or the sticks of a gamepad say where the hand goes and how fast, and
// a simulated Touch moves as a real one would in that hand.
#pragma once

#include "haptics/devices/hid_listener.hpp"
#include "haptics/devices/simulated_touch.hpp"

namespace palpate {

/// The hand has inertia and yields to the force. It presses as hard as the cap is pushed: the intention runs ahead of
/// the stylus only so far, less when the cap is let go. A device that is unplugged leaves the stylus where it is,
/// without force, and takes it up there again. At the beginning, too, the hand waits while forces ramp up. A thread of
/// its own listens; read() and write() wait for nobody.
class HidDevice final : public HapticDevice {
 public:
  /// `device`: one that chooseHidSteering() gave. The stylus begins at `start_mm`. Throws Error where it cannot be
  /// opened.
  HidDevice(std::shared_ptr<HidTransport> transport, const HidInfo& device, const DVec3& start_mm, HidRemark remark);

  std::string_view name() const override { return name_; }
  /// Of a Touch, but for its heat: there are no motors.
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override { return adrift_ || hand_.write(force_N); }
  void emergencyStop() noexcept override { hand_.emergencyStop(); }
  std::string faultText() const override { return {}; }

 private:
  DVec3 intendedAt(double time_s) noexcept;

  std::string name_;
  HidListener listener_;
  DVec3 asked_mm_per_s_{0};
  bool adrift_ = true;  // no device holds the stylus; it has none before the first read either
  DVec3 position_mm_, intended_mm_, speed_mm_per_s_{0};
  double intendedTime_s_ = 0, waitsUntil_s_ = 0;
  SimulatedTouch hand_;
};

}  // namespace palpate
