// Input of devices that are pushed rather than moved, independent of the layout of their reports.
#pragma once

#include <cstdint>
#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

struct HidMotion {
  DVec3 push{0};  ///< of the cap or stick, -1 to 1 on each axis: x right, y up, z towards the user
  DVec3 turn{0};  ///< rotation around the same axes, right-handed, -1 to 1; 0 if a device does not measure it
  std::uint32_t buttons = 0;  ///< bit 0 is the first button
};

/// Parses a report into `motion`, and leaves its other fields unchanged. False: not a report of such a device, too
/// short, or of no interest here; `motion` is unchanged.
using TakeHidReport = bool (*)(std::span<const std::uint8_t> report, HidMotion& motion) noexcept;

/// 3D mice. Report 1 has the translation, three int16 little-endian up to about 350, and on newer devices the rotation
/// behind it; report 2 has the rotation on others; report 3 has the buttons, a bit each. Axes: x right, y towards the
/// user, z down.
bool takeSpaceMouseReport(std::span<const std::uint8_t> report, HidMotion& motion) noexcept;

/// The input report of a DualSense over USB: the left stick moves right and up, the right one away and back. Its
/// buttons are cross, circle, square, triangle, L1, R1.
bool takeDualSenseReport(std::span<const std::uint8_t> report, HidMotion& motion) noexcept;

}  // namespace palpate
