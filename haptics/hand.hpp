// One hand in a session: the device that it holds, and all that stands between the surface's answer and its force.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/core/contact_query.hpp"
#include "haptics/clutch.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/force_gate.hpp"
#include "haptics/force_law.hpp"
#include "haptics/passivity.hpp"
#include "haptics/trace.hpp"

namespace palpate {

struct HandOptions {
  WorkspaceMap map;                        ///< at first; the device's clutch moves it
  std::optional<PassivityMode> passivity;  ///< unless set: on for a device in a hand, off for a script
};

/// What of a tick the answer does not say.
struct TickConditions {
  bool forcesOn = true;     ///< the user wants forces
  double known = 1;         ///< TickSigns::known
  bool isChanging = false;  ///< ForceLaw::setChanging(); how far the surface moves then is somebody else's work
};

/// What a hand's session came to beside its rows.
struct HandCounts {
  GateCounts withheld;
  std::optional<double> leastEnergy_mJ;  ///< that the surface had ever taken in; see Passivity
};

/// In each tick, in this order: read(), feel(), write(), note().
class Hand {
 public:
  /// The device outlives it. The force is limited to the device's peak. `toolPoints`: of what it touches with; 0 for
  /// the HIP alone. Throws UsageError for a passivity controller on a device that yields to no force.
  Hand(HapticDevice& device, ForceLaw law, const HandOptions& options, double rate_Hz, std::size_t toolPoints);

  HapticDevice& device() const noexcept { return *device_; }
  /// The device's fault in words.
  std::string faultText() const;
  HandCounts counts() const;

  /// A session begins.
  void begin();

  /// Asks the device where it is. False when that failed.
  bool read(double time_s) noexcept;
  const DeviceState& state() const noexcept { return state_; }
  const DVec3& hip() const noexcept { return hip_; }  ///< model units
  /// It means to change what it touches.
  bool sculpts() const noexcept;

  /// The answer's force, to be written. `points`: of a tool.
  void feel(const Contact& answer, std::span<const PointContact> points, const Pose& pose, double dt_s,
            const TickConditions& conditions) noexcept;
  /// False when the force did not reach the device.
  bool write() noexcept;
  /// At the last tick.
  const FeltForce& felt() const noexcept { return felt_; }
  /// The device has, or gets, no force at this tick after all: another one failed.
  void takeForceAway() noexcept;
  /// What this tick was.
  void note(TraceRow& row) const noexcept;

 private:
  /// The force to write. A tool's torque goes with it: as much of it as of the force passes.
  DVec3 forceFor(std::span<const PointContact> points, const Pose& pose, double dt_s,
                 const TickConditions& conditions) noexcept;
  /// Of the surface, model units per second, by itself or as others change it.
  DVec3 surfaceVelocity(bool isChanging, double dt_s) noexcept;
  /// Of the spring between hand and surface, by the way of the device.
  double springOfDevice_N_per_mm() const noexcept;
  /// Whether the device moved faster than a hand can since the last tick.
  bool hasJumped(const DVec3& position, double dt_s) noexcept;

  HapticDevice* device_;
  ForceLaw law_;
  HandOptions options_;
  double rate_Hz_;
  DeviceLimits limits_;
  PassivityMode passivityMode_;
  Passivity passivity_;
  ForceGate gate_;
  Clutch clutch_;
  std::optional<DVec3> lastPosition_;  ///< of the device, in its own unit
  std::optional<DVec3> lastProxy_;     ///< where a point touched, by a fresh answer

  // Of this tick.
  DeviceState state_;
  DVec3 hip_{0};
  Contact contact_;
  DVec3 force_N_{0}, torque_mNm_{0};
  bool written_ = false;
  FeltForce felt_;
};

}  // namespace palpate
