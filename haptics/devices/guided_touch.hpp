// A stylus without a haptic device: a mouse, keys or a gamepad set the intended position, and a simulated Touch moves
// as a real one would in that hand.
#pragma once

#include "engine/core/latest_value.hpp"
#include "haptics/devices/simulated_touch.hpp"

namespace palpate {

/// The hand of a user without a device: no friction and no perceptible encoder steps, with stops at the sides of
/// `workspace_mm`.
SimulatedTouchOptions guidedHand(const DVec3& workspace_mm);

/// The hand has inertia and yields to the force: the surface holds the stylus back while the aim sinks in. One thread
/// aims, another one reads and writes; neither waits for the other.
class GuidedTouch final : public HapticDevice {
 public:
  /// `map`: from the device's space to the model's; `parked`: position of the stylus while it is lifted, model units.
  GuidedTouch(const WorkspaceMap& map, const DVec3& parked);

  // For the thread that aims.
  /// Sets the intended position, model units, and whether the button that sculpts is held. Puts a lifted stylus down
  /// there.
  void aim(const DVec3& place, bool sculpts = true) noexcept;
  /// As aim(), but the stylus is put down there instead of moved there.
  void putDown(const DVec3& place, bool sculpts) noexcept;
  /// Takes the stylus away from the model, with its button released.
  void lift() noexcept;

  std::string_view name() const override { return "guided stylus"; }
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override { return hand_.write(force_N); }
  void emergencyStop() noexcept override { hand_.emergencyStop(); }
  std::string faultText() const override { return {}; }

 private:
  struct Aim {
    DVec3 place{0};
    bool lifted = true, sculpts = false;
    std::uint32_t putDowns = 0;  // number of times the stylus was put down
  };

  DVec3 parked_;
  LatestValue<Aim> latest_;
  Aim aim_;  // used by the thread that aims
  // Used by the thread that reads.
  Aim last_;
  DVec3 glide_;
  double glideTime_s_ = 0;
  SimulatedTouch hand_;
};

}  // namespace palpate
