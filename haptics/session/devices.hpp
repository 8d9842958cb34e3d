// The haptic devices that a user can name.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "engine/core/log.hpp"
#include "haptics/devices/device_axes.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/session/device_memory.hpp"
#include "haptics/session/device_survey.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// A held device, ready for use, with the axes of its user and within the stiffness that is remembered for it.
struct OpenedDevice {
  std::unique_ptr<HapticDevice> device;
  HapticDeviceFacts facts;
  DeviceLimits limits;          ///< its own; for a test, since what is remembered limits the stiffness of `device`
  DeviceAxes axes;              ///< in use: as asked for, else as remembered
  std::string key;              ///< deviceKey(); empty if it reports no serial number
  RememberedDevice remembered;  ///< for it; empty: nothing
};

/// Whether `spec` (HandConfig::device) names a held device: openhaptics[:NAME], dhd[:NUMBER],
/// haply[:SERIAL][:shared] or hid[:WHICH].
bool isHeldDevice(const std::string& spec);
/// List of the held devices, for a help text and for the error about an unknown one.
std::string heldDevicesHelp();
/// Their names, after those in `before`: what completion offers.
std::vector<std::string> heldDeviceNames(std::vector<std::string> before = {});
/// Whether it only steers a simulated hand, without a force of its own.
bool isSteering(const std::string& spec);

/// Surveys each kind, which may take seconds. `held`: the device that this program uses, whose driver is left alone.
std::vector<DeviceSurvey> surveyDevices(const std::string& held = {});
/// The same for the kind of `held` alone.
DeviceSurvey surveyKindOf(const std::string& held);

struct DeviceOpening {
  Log& log;
  double rate_Hz = 1000;                    ///< of the ticks
  bool ownScheduler = false;                ///< palpate's servo thread runs the ticks, not the driver
  const std::atomic<bool>* stop = nullptr;  ///< ends the wait for a calibration by hand
  std::string axes;                         ///< DeviceAxes::text(); empty: those that are remembered
  DeviceMemory memory{};
};
/// Opens the device, and says what is remembered for it. Throws Error with the missing component and the remedy.
OpenedDevice openDevice(const std::string& spec, const DeviceOpening& opening);

/// The same device, with a DualSense that rumbles at each contact. Throws Error if there is no DualSense.
std::unique_ptr<HapticDevice> withRumble(std::unique_ptr<HapticDevice> device, Log& log);

/// Maps the middle of the model to the middle of the device's workspace: at true scale if it fits, else shrunk until it
/// does (the surface then feels stiffer by the same factor).
WorkspaceMap mapInto(const HapticDeviceFacts& facts, const Model& model);

}  // namespace palpate
