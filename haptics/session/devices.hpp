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

/// A held device, ready for use.
struct OpenedDevice {
  std::unique_ptr<HapticDevice> device;
  HapticDeviceFacts facts;
};

/// Whether `spec` (HandConfig::device) names a held device: openhaptics[:NAME], dhd[:NUMBER],
/// haply[:SERIAL][:shared] or hid[:WHICH].
bool isHeldDevice(const std::string& spec);
/// List of the held devices, for a help text and for the error about an unknown one.
std::string heldDevicesHelp();

struct DeviceOpening {
  Log& log;
  double rate_Hz = 1000;                    ///< of the ticks
  bool ownScheduler = false;                ///< palpate's servo thread runs the ticks, not the driver
  const std::atomic<bool>* stop = nullptr;  ///< ends the wait for a calibration by hand
};
/// Opens the device. Throws Error with the missing component and the remedy.
OpenedDevice openDevice(const std::string& spec, const DeviceOpening& opening);

/// The same device, with a DualSense that rumbles at each contact. Throws Error if there is no DualSense.
std::unique_ptr<HapticDevice> withRumble(std::unique_ptr<HapticDevice> device, Log& log);

/// Maps the middle of the model to the middle of the device's workspace: at true scale if it fits, else shrunk until it
/// does (the surface then feels stiffer by the same factor).
WorkspaceMap mapInto(const HapticDeviceFacts& facts, const Model& model);

}  // namespace palpate
