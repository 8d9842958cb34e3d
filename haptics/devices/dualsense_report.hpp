// Output reports for a DualSense over USB. Layout as in Linux, drivers/hid/hid-playstation.c.
#pragma once

#include <array>
#include <cstdint>

namespace palpate {

/// Intensities of the two motors, 0 to 255.
struct RumbleMotors {
  std::uint8_t strong = 0;  ///< the heavy one, on the left: a low hum
  std::uint8_t weak = 0;    ///< the light one, on the right: a quick buzz
  bool operator==(const RumbleMotors&) const = default;
};

inline constexpr std::uint16_t kSony = 0x054c, kDualSense = 0x0ce6, kDualSenseEdge = 0x0df2;

/// The output report that sets the motors and leaves lights, triggers and sound unchanged.
std::array<std::uint8_t, 48> dualSenseRumble(RumbleMotors motors, std::uint16_t productId) noexcept;

}  // namespace palpate
