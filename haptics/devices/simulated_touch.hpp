// A Geomagic Touch that is not there: stylus, motors, encoders and a hand, for closed loops without hardware.
#pragma once

#include <atomic>
#include <functional>

#include "engine/core/units.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/path.hpp"

namespace palpate {

/// Of a Geomagic Touch: x right, y up, z towards the user; the device's origin is in the middle.
inline constexpr DVec3 kTouchWorkspace_mm{160, 120, 70};

struct SimulatedTouchOptions {
  /// Between the stylus and where the hand means to be. A relaxed pen grip has 0.2 to 1 N/mm and 1 to 5 N s/m.
  double handStiffness_N_per_mm = 0.4;
  double handDamping_N_s_per_mm = 0.002;
  double mass_kg = 0.045;              ///< that the stylus seems to have at its tip
  double viscosity_N_s_per_mm = 5e-4;  ///< of the joints
  double friction_N = 0.26;            ///< Coulomb, moving and at rest
  double encoderStep_mm = 0.055;
  double lead_s = 0;                        ///< the hand waits this long at the beginning of its path
  DVec3 workspace_mm = kTouchWorkspace_mm;  ///< the stops are at its sides
};

/// A mass that the motors, friction and the hand act on; the hand's intention follows a path. The force is held from
/// tick to tick and comes one tick late, the position is read in whole encoder steps. Deterministic: the same reads and
/// writes give the same positions, in virtual and in real time. A read at an earlier time begins anew.
class SimulatedTouch final : public HapticDevice {
 public:
  /// Where the hand means to be at a time, model units. Is asked for times that do not fall, but for the first; throws
  /// and allocates nothing.
  using Intention = std::function<DVec3(double time_s)>;

  /// `map` says where the intention lies in the workspace. Throws UsageError for options that are not finite or out of
  /// range.
  SimulatedTouch(Intention intention, const WorkspaceMap& map, const SimulatedTouchOptions& options = {});
  SimulatedTouch(const Path& path, const WorkspaceMap& map, const SimulatedTouchOptions& options = {});

  std::string_view name() const override { return "simulated Touch"; }
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  void emergencyStop() noexcept override { stopped_ = true; }
  std::string faultText() const override { return {}; }

  /// Until the hand has come to the end of its path; 0 where it has none.
  double duration_s() const { return options_.lead_s + pathDuration_s_; }
  /// Begins anew at `time_s`, at rest where the hand means to be then.
  void putDown(double time_s) noexcept { begin(time_s); }
  /// Where the stylus is, finer than the encoders tell.
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
  DVec3 acting_N_{0};   ///< of the motors, from the last read on
  DVec3 written_N_{0};  ///< acts from the next read on
  std::atomic<bool> stopped_ = false;
};

/// Puts a path in the middle of the workspace: true to scale where it fits, otherwise shrunk until it does (the surface
/// is then felt stiffer by as much). Its millimetre is the model's.
WorkspaceMap workspaceAround(const Path& path, const ModelScale& scale);
/// The same for a box, model units, that takes at most `usedShare` of the workspace along each axis.
WorkspaceMap workspaceAround(const DVec3& low, const DVec3& high, const ModelScale& scale, double usedShare);

}  // namespace palpate
