// Which of the HID devices that are plugged in serve palpate, which one is meant, and what to do about those that
// cannot be used.
#pragma once

#include <string_view>

#include "haptics/devices/hid_transport.hpp"

namespace palpate {

enum class HidKind {
  none,
  spaceMouse,   ///< a 3D mouse of any make: usage page 1, usage 8 (multi-axis controller)
  dualSense,    ///< of Sony; sticks and rumble
  hapticStylus  ///< of 3D Systems, the one without a serial port; OpenHaptics speaks to it
};
HidKind kindOf(const HidInfo& info) noexcept;

/// "SpaceMouse Compact (256f:c635)"; maker and kind step in where a device has no name.
std::string nameOf(const HidInfo& info);

/// A device that serves, as `palpate doctor` lists it.
struct HidCandidate {
  HidInfo info;
  HidKind kind = HidKind::none;
  std::string name;
  bool usable = false;
  std::string whyNot;  ///< empty where it is usable
  std::string mend;    ///< "run: " and a command, or what else to do; empty where it is usable
};
/// Opens each of them once, which changes nothing in it, and closes it again.
std::vector<HidCandidate> hidCandidates(HidTransport& transport);

/// The device that steers: `wanted` is empty for the first one that can be used, 3D mice before DualSenses, else a
/// path, a serial number or "VID:PID" (hexadecimal). Throws Error that says what was looked for and seen, and how to
/// mend it.
HidInfo chooseHidSteering(HidTransport& transport, std::string_view wanted);

/// The DualSense that rumbles. Throws Error.
HidInfo chooseDualSense(HidTransport& transport);

}  // namespace palpate
