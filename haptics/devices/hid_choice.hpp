// Which connected HID devices palpate can use, which one is selected, and what to do about those that cannot be used.
#pragma once

#include <string_view>

#include "haptics/devices/hid_transport.hpp"

namespace palpate {

enum class HidKind {
  none,
  spaceMouse,   ///< a 3D mouse of any make: usage page 1, usage 8 (multi-axis controller)
  dualSense,    ///< of Sony; sticks and rumble
  hapticStylus  ///< of 3D Systems, without a serial port; used through OpenHaptics
};
HidKind kindOf(const HidInfo& info) noexcept;

/// "SpaceMouse Compact (256f:c635)"; maker and kind are used if a device has no name.
std::string nameOf(const HidInfo& info);

/// A supported device, as `palpate doctor` lists it.
struct HidCandidate {
  HidInfo info;
  HidKind kind = HidKind::none;
  std::string name;
  bool usable = false;
  std::string whyNot;  ///< empty if it is usable
  std::string mend;    ///< "run: " and a command, or what else to do; empty if it is usable
};
/// Opens each of them once, which does not change its state, and closes it again.
std::vector<HidCandidate> hidCandidates(HidTransport& transport);

/// The device that steers: `wanted` is empty for the first usable one, 3D mice before DualSenses, otherwise a path, a
/// serial number or "VID:PID" (hexadecimal). Throws Error that says what was looked for and found, and what to do.
HidInfo chooseHidSteering(HidTransport& transport, std::string_view wanted);

/// The DualSense that rumbles. Throws Error.
HidInfo chooseDualSense(HidTransport& transport);

}  // namespace palpate
