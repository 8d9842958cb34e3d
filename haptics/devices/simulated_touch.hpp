// A simulated Geomagic Touch: stylus, motors, encoders and a hand, for closed loops without hardware.
#pragma once

#include <atomic>
#include <functional>

#include "engine/core/units.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/path.hpp"

namespace palpate {

/// Workspace of a Geomagic Touch: x right, y up, z towards the user; the device's origin is in the middle.
inline constexpr DVec3 kTouchWorkspace_mm{160, 120, 70};

struct SimulatedTouchOptions {
  /// Between the stylus and the intended position of the hand. A relaxed pen grip has 0.2 to 1 N/mm and 1 to 5 N s/m.
  double handStiffness_N_per_mm = 0.4;
  double handDamping_N_s_per_mm = 0.002;
  double mass_kg = 0.045;              ///< apparent mass at the tip of the stylus
  double viscosity_N_s_per_mm = 5e-4;  ///< of the joints
  double friction_N = 0.26;            ///< Coulomb, moving and at rest
  double encoderStep_mm = 0.055;
  double lead_s = 0;                        ///< delay before the hand starts along its path
  DVec3 workspace_mm = kTouchWorkspace_mm;  ///< the stops are at its sides
};

/// A mass that the motors, friction and the hand act on; the intended position of the hand follows a path. The force is
/// held from tick to tick and delayed by one tick, the position is read in whole encoder steps. Deterministic: the same
/// reads and writes give the same positions, in virtual and in real time. A read at an earlier time restarts it.
class SimulatedTouch final : public HapticDevice {
 public:
  /// Intended position of the hand at a time, model units. Times do not decrease, except at a restart; must neither
  /// throw nor allocate.
  using Intention = std::function<DVec3(double time_s)>;

  /// `map`: from the workspace to the intended positions. Throws UsageError for options that are not finite or out of
  /// range.
  SimulatedTouch(Intention intention, const WorkspaceMap& map, const SimulatedTouchOptions& options = {});
  SimulatedTouch(const Path& path, const WorkspaceMap& map, const SimulatedTouchOptions& options = {});

  std::string_view name() const override { return "simulated Touch"; }
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  void emergencyStop() noexcept override { stopped_ = true; }
  bool isStopped() const noexcept override { return stopped_; }
  void resume() noexcept override { stopped_ = false; }
  std::string faultText() const override { return {}; }

  /// Time until the hand reaches the end of its path, `lead_s` included.
  double duration_s() const { return options_.lead_s + pathDuration_s_; }
  /// Restarts at `time_s`, at rest at the position intended then.
  void putDown(double time_s) noexcept { begin(time_s); }
  /// Exact position of the stylus, without the steps of the encoders.
  DVec3 position_mm() const { return position_mm_; }

 private:
  DVec3 intendedAt(double time_s) const noexcept;
  void begin(double time_s) noexcept;
  void advance(double time_s) noexcept;
  void step(const DVec3& intended_mm, const DVec3& intendedSpeed_mm_per_s, double dt_s) noexcept;

  Intention intention_;
  double pathDuration_s_ = 0;
  WorkspaceMap map_;
  SimulatedTouchOptions options_;
  bool begun_ = false;
  double now_s_ = 0;
  DVec3 position_mm_{0}, velocity_mm_per_s_{0};
  DVec3 acting_N_{0};   ///< of the motors, since the last read
  DVec3 written_N_{0};  ///< acts from the next read on
  std::atomic<bool> stopped_ = false;
};

/// Centers a path in the workspace: true to scale if it fits (a millimetre of the device is one of the model),
/// otherwise shrunk until it does (the surface is then felt stiffer by that factor).
WorkspaceMap workspaceAround(const Path& path, const ModelScale& scale);
/// The same for a box, model units, that takes at most `usedShare` of the workspace along each axis.
WorkspaceMap workspaceAround(const DVec3& low, const DVec3& high, const ModelScale& scale, double usedShare);

}  // namespace palpate
