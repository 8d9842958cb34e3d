// What devices that are pushed rather than moved say, whatever their reports look like.
#pragma once

#include <cstdint>
#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

struct HidMotion {
  DVec3 push{0};              ///< of the cap or stick, -1 to 1 on each axis: x right, y up, z towards the user
  DVec3 turn{0};              ///< around the same axes, right-handed, -1 to 1; 0 where a device does not turn
  std::uint32_t buttons = 0;  ///< bit 0 is the first button
};

/// Takes what a report says into `motion` and leaves the rest of it as it was. False: this is no report of such a
/// device, too short, or of no interest here; `motion` is as it was.
using TakeHidReport = bool (*)(std::span<const std::uint8_t> report, HidMotion& motion) noexcept;

/// 3D mice. Report 1 has the translation, three int16 little-endian up to about 350, and on newer devices the rotation
/// behind it; report 2 the rotation on others; report 3 the buttons, a bit each. They count x right, y towards the user
/// and z down.
bool takeSpaceMouseReport(std::span<const std::uint8_t> report, HidMotion& motion) noexcept;

/// The input report of a DualSense over USB: the left stick moves right and up, the right one away and back. Its
/// buttons are cross, circle, square, triangle, L1, R1.
bool takeDualSenseReport(std::span<const std::uint8_t> report, HidMotion& motion) noexcept;

}  // namespace palpate
