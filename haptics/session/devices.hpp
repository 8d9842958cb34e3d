// The haptic devices that a user can name.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "engine/core/log.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// A device in a hand, ready to be felt.
struct OpenedDevice {
  std::unique_ptr<HapticDevice> device;
  HapticDeviceFacts facts;
};

/// Whether `spec` (HandConfig::device) names what a person holds: openhaptics[:NAME], dhd[:NUMBER] or hid[:WHICH].
bool isHeldDevice(const std::string& spec);
/// Those that there are, for a help text and for the error when it is something else.
std::string heldDevicesHelp();

struct DeviceOpening {
  Log& log;
  double rate_Hz = 1000;                    ///< of the ticks to come
  bool ownScheduler = false;                ///< palpate's servo thread calls the ticks, where the driver would
  const std::atomic<bool>* stop = nullptr;  ///< ends the wait for a person who has to calibrate
};
/// Opens it. Throws Error with what is missing and what to do.
OpenedDevice openDevice(const std::string& spec, const DeviceOpening& opening);

/// The same device, with a DualSense that rumbles at each contact. Throws Error where there is none.
std::unique_ptr<HapticDevice> withRumble(std::unique_ptr<HapticDevice> device, Log& log);

/// The middle of the model in the middle of the device's workspace: true to scale where it fits, otherwise shrunk until
/// it does (the surface is then felt stiffer by as much).
WorkspaceMap mapInto(const HapticDeviceFacts& facts, const Model& model);

}  // namespace palpate
