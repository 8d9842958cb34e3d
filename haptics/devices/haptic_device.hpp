// The interface between the servo loop and a haptic device, which provides the pose of the hand and takes a force.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/units.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

struct DeviceState {
  DVec3 position{0};          ///< of the stylus tip, in the device's own unit (mm for hardware)
  DQuat turn{1, 0, 0, 0};     ///< of the stylus, whose tip points along its own -z; identity if it is not measured
  std::uint32_t buttons = 0;  ///< pressed now; bit 0 is the first button
  bool putDown = false;       ///< it was lifted since the last read: there was no motion from that position to this one
  /// False: no force reaches the hand in this tick, a temporary fault of the device; later it ramps up again.
  bool rendersForce = true;
  /// The position of this tick is not known yet, where ticks are counted: nothing is asked, and there is no force.
  bool waits = false;
  /// Nothing moves the device but a program, which then calls ServoMailbox::wake(): the loop may sleep until then.
  bool rests = false;
  bool ok = false;  ///< false: the device failed; the other fields are invalid
};

/// Limits and properties of a device; those of a Geomagic Touch unless an adapter sets others.
struct DeviceLimits {
  double peakForce_N = kTouchPeakForce_N;
  double continuousForce_N = 0.88;  ///< that the motors sustain for minutes
  /// Maximum speed of a stylus in a hand (a hard throw reaches about a third of it); a larger step between two reads
  /// means that the device lost its count.
  double fastest_mm_per_s = 5000;
  /// Maximum damping that the device renders stably. A damper with a delay of about two ticks destabilizes a mass m at
  /// about m / (2 T), 22 N s/m for the Touch at 1 kHz; a quarter of it leaves room for the encoder's steps.
  double mostDamping_N_s_per_mm = 0.005;
  /// Maximum stiffness that it renders stably.
  double mostStiffness_N_per_mm = std::numeric_limits<double>::infinity();
  int forceDelay_ticks = 0;  ///< whole ticks between write() and the effect of the force, 0 to 3
  /// A hand, or a model of one, feels the force and yields to it. False for a script that moves regardless of it:
  /// no person has to be protected at the start of a session, and there is no closed loop that could become unstable.
  bool handHeld = true;
  /// The time of a session is the number of its ticks, without those that came too late or at which the device waited:
  /// its motion then has the same effect on any machine. Only the first hand's counts.
  bool countsTicks = false;
  int buttons = 0;  ///< number of them: kSculptButton sculpts, kClutchButton draws the clutch
};

constexpr std::uint32_t kSculptButton = 1, kClutchButton = 2;  ///< bits of DeviceState::buttons

/// Facts that a device reports.
struct HapticDeviceFacts {
  std::string model, serial, driver;
  std::string handedness, axes;  ///< as set up, in words; empty if unknown
  DVec3 workspaceMin_mm{0}, workspaceMax_mm{0};
  std::string grip;               ///< that it holds, in words; empty: it has none of its own
  std::optional<double> battery;  ///< of the grip when it was opened, 0 to 1; empty if it does not tell
  std::string lights;             ///< meaning of its lights, a line each; empty if it has none
};

/// A device that a person holds, a model of one, or a script. Axes x right, y up, z towards the user. read() and
/// write() are called on one thread, once per tick each; they do not throw or allocate, and return within a fraction of
/// a tick.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  virtual std::string_view name() const = 0;
  virtual DeviceLimits limits() const = 0;

  /// Whether the device calls ticks in real time on its own thread and at its own pace.
  virtual bool paces() const { return false; }
  /// Calls `tick`, `rate_Hz` times a second, until it returns false. Returns false, with the fault in faultText(), if
  /// the device stops calling earlier; `tick` is then no longer called. Only if it paces().
  virtual bool pace(double /*rate_Hz*/, const std::function<bool()>& /*tick*/) { return false; }

  /// `time_s`: since the session began; a real device ignores it.
  virtual DeviceState read(double time_s) noexcept = 0;

  /// The way to the proxy at this tick, in the device's own unit; nothing without contact. Before write().
  virtual void feel(const std::optional<DVec3>& /*toProxy*/) noexcept {}

  /// False if the force did not reach the device.
  virtual bool write(const DVec3& force_N) noexcept = 0;

  /// Removes the force: no later write() restores it, until resume(). Called from signal handlers, on any thread and in
  /// the middle of a write(), so it must be async-signal-safe: no locks, no allocations, no exceptions.
  virtual void emergencyStop() noexcept = 0;
  /// Whether it was stopped: the hand feels nothing, whatever is written. For any thread.
  virtual bool isStopped() const noexcept { return false; }
  /// After emergencyStop(), in a program that goes on: the next write() has a force again. For any thread.
  virtual void resume() noexcept {}

  /// The first fault, and what to do about it; empty if there is none. Never called during a tick.
  virtual std::string faultText() const = 0;
};

/// Device coordinates to the model's file coordinates. Without rotation and mirroring, so that forces pass unchanged.
struct WorkspaceMap {
  double scale = 1;  ///< model units per device unit
  DVec3 offset{0};   ///< model units

  DVec3 toModel(const DVec3& device) const { return scale * device + offset; }
};

}  // namespace palpate
