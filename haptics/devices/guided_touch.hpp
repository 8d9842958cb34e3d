// A stylus for those who have none: a mouse, keys or a gamepad say where the hand means to be, and a simulated Touch
// moves as a real one would in that hand.
#pragma once

#include "engine/core/latest_value.hpp"
#include "haptics/devices/simulated_touch.hpp"

namespace palpate {

/// The hand of someone who holds no device: one without friction and encoder steps, with stops at the sides of
/// `workspace_mm`.
SimulatedTouchOptions guidedHand(const DVec3& workspace_mm);

/// The hand has inertia and yields to the force: the surface holds the stylus back while the aim sinks in. One thread
/// aims, another one reads and writes; neither waits for the other.
class GuidedTouch final : public HapticDevice {
 public:
  /// `map`: where the model lies in the device's space; `parked`: where the stylus is while it is lifted, model units.
  GuidedTouch(const WorkspaceMap& map, const DVec3& parked);

  // For the thread that aims.
  /// Where the hand means to be, model units, and whether it holds the button that sculpts. A lifted stylus is put down
  /// there.
  void aim(const DVec3& place, bool sculpts = true) noexcept;
  /// Takes the stylus away from the model.
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
    std::uint32_t putDowns = 0;  // how often the stylus was put down so far
  };

  DVec3 parked_;
  LatestValue<Aim> latest_;
  Aim aim_;  // of the thread that aims
  // Of the thread that reads.
  Aim last_;
  DVec3 glide_;
  double glideTime_s_ = 0;
  SimulatedTouch hand_;
};

}  // namespace palpate
