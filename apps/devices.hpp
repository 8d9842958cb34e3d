// The haptic devices that a user can name.
#pragma once

#include "apps/context.hpp"
#include "apps/model.hpp"
#include "haptics/devices/openhaptics_device.hpp"

namespace palpate {

/// A device in a hand, ready to be felt.
struct OpenedDevice {
  std::unique_ptr<HapticDevice> device;
  HapticDeviceFacts facts;
};

/// Whether `spec` (--device) names what a person holds: openhaptics[:NAME], dhd[:NUMBER] or hid[:WHICH].
bool isHeldDevice(const std::string& spec);
/// What --device takes, for its help and for the error when it is something else.
std::string heldDevicesHelp();

/// Opens it. `rate_Hz`: of the ticks to come; `stop` ends the wait for a person who has to calibrate. Throws Error with
/// what is missing and what to do.
OpenedDevice openDevice(const std::string& spec, Scheduler scheduler, double rate_Hz, Log& log,
                        const std::atomic<bool>* stop);

/// The same device, with a DualSense that rumbles at each contact. Throws Error where there is none.
std::unique_ptr<HapticDevice> withRumble(std::unique_ptr<HapticDevice> device, Log& log);

/// The middle of the model in the middle of the device's workspace: true to scale where it fits, otherwise shrunk until
/// it does (the surface is then felt stiffer by as much).
WorkspaceMap mapInto(const HapticDeviceFacts& facts, const Model& model);

}  // namespace palpate
