// What the servo loop knows of a haptic device: it says where the hand is and takes a force.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

#include "engine/core/units.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

struct DeviceState {
  DVec3 position{0};          ///< of the stylus tip, in the device's own unit (mm for hardware)
  DQuat turn{1, 0, 0, 0};     ///< of the stylus, whose tip looks along its own -z; none where the device cannot tell
  std::uint32_t buttons = 0;  ///< pressed now; bit 0 is the first button
  bool putDown = false;       ///< it was lifted since the last read, and there was no motion from there to here
  /// False: no force reaches the hand at this tick, a passing trouble of the device; later it ramps up again.
  bool rendersForce = true;
  bool ok = false;  ///< false: the device failed; the other fields say nothing
};

/// What a device bears and what it is; a Geomagic Touch unless an adapter knows better.
struct DeviceLimits {
  double peakForce_N = kTouchPeakForce_N;
  double continuousForce_N = 0.88;  ///< what the motors bear for minutes
  /// No hand moves a stylus faster (a hard throw reaches about a third of it); a larger step between two reads means
  /// that the device lost its count.
  double fastest_mm_per_s = 5000;
  /// The strongest damping that the device still renders calmly. A damper that answers about two ticks late shakes a
  /// mass m at about m / (2 T), 22 N s/m for the Touch at 1 kHz; a quarter of it leaves room for the encoder's steps.
  double mostDamping_N_s_per_mm = 0.005;
  /// The stiffest spring that it renders calmly.
  double mostStiffness_N_per_mm = std::numeric_limits<double>::infinity();
  int forceDelay_ticks = 0;  ///< whole ticks between write() and the force being there, 0 to 3
  /// A hand, or a model of one, feels the force and yields to it. False for a script that moves whatever it meets:
  /// there is no one to protect from the start of a session, and no closed loop that could become unstable.
  bool handHeld = true;
  int buttons = 0;  ///< on the stylus: with kSculptButton it sculpts, and with kClutchButton the clutch is drawn
};

constexpr std::uint32_t kSculptButton = 1, kClutchButton = 2;  ///< bits of DeviceState::buttons

/// What a device says of itself.
struct HapticDeviceFacts {
  std::string model, serial, driver;
  DVec3 workspaceMin_mm{0}, workspaceMax_mm{0};
};

/// A device that a person holds, a model of one, or a script. Axes x right, y up, z towards the user. read() and
/// write() come from one thread, once per tick each; they throw nothing, allocate nothing and return within a fraction
/// of a tick.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  virtual std::string_view name() const = 0;
  virtual DeviceLimits limits() const = 0;

  /// Whether ticks in real time run on a thread and at a pace of the device's own.
  virtual bool paces() const { return false; }
  /// Calls `tick`, `rate_Hz` times a second, until it returns false. Returns false, with the fault in faultText(), when
  /// the device stops calling before that; `tick` is then not called any more. Only where it paces().
  virtual bool pace(double /*rate_Hz*/, const std::function<bool()>& /*tick*/) { return false; }

  /// `time_s` since the session began; a real device ignores it.
  virtual DeviceState read(double time_s) noexcept = 0;

  /// False when the force did not reach the device.
  virtual bool write(const DVec3& force_N) noexcept = 0;

  /// Takes the force away for good: no later write() brings it back. Called from signal handlers, on any thread and in
  /// the middle of a write(), so it may only do what is async-signal-safe: no lock, no memory, no exception.
  virtual void emergencyStop() noexcept = 0;

  /// The first fault in words and what to do about it; empty while all is well. Never called during a tick.
  virtual std::string faultText() const = 0;
};

/// Device coordinates to the model's file coordinates. It neither turns nor mirrors, so forces pass unchanged.
struct WorkspaceMap {
  double scale = 1;  ///< model units per device unit
  DVec3 offset{0};   ///< model units

  DVec3 toModel(const DVec3& device) const { return scale * device + offset; }
};

}  // namespace palpate
