// What the servo loop knows of a haptic device: it says where the hand is and takes a force.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/core/units.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

struct DeviceState {
  DVec3 position{0};          ///< of the stylus tip, in the device's own unit (mm for hardware)
  std::uint32_t buttons = 0;  ///< bit 0 is the first button
  bool ok = false;            ///< false: the device failed; the other fields say nothing
};

struct DeviceLimits {
  double peakForce_N = kTouchPeakForce_N;
  double continuousForce_N =
      0.88;  ///< what the motors bear for minutes; a Geomagic Touch unless an adapter knows better
};

/// Axes x right, y up, z towards the user. read() and write() come from one thread, once per tick each; they throw
/// nothing, allocate nothing and return within a fraction of a tick.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  virtual std::string_view name() const = 0;
  virtual DeviceLimits limits() const = 0;

  /// `time_s` since the session began; a real device ignores it.
  virtual DeviceState read(double time_s) noexcept = 0;

  /// False when the force did not reach the device.
  virtual bool write(const DVec3& force_N) noexcept = 0;

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
