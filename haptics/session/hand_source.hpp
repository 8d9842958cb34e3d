// The sources of a HIP's poses: a haptic device in a person's hand, a script, a recording, or a simulated hand.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "haptics/devices/haptic_device.hpp"
#include "haptics/passivity.hpp"
#include "haptics/session/device_memory.hpp"
#include "haptics/session/model.hpp"
#include "haptics/trajectory.hpp"

namespace palpate {

/// A hand of a session for one run; does not own the device.
struct OpenHand {
  HapticDevice* device = nullptr;
  WorkspaceMap map;
  double duration_s = 0;  ///< of its path or recording; 0: unlimited
  std::optional<PassivityMode> passivity;
};

/// A hand with its open device.
struct HandSource {
  std::unique_ptr<HapticDevice> device;
  WorkspaceMap map;
  double duration_s = 0;  ///< of its path or recording; 0: unlimited
  std::optional<PassivityMode> passivity;
  std::optional<Trajectory> recorded;  ///< with its forces, if a trajectory is replayed
  RememberedDevice remembered;         ///< for a held device

  OpenHand hand() const { return {device.get(), map, duration_s, passivity}; }
};

struct HandOpening {
  const Model& model;
  double rate_Hz = 1000;
  Log& log;
  const std::atomic<bool>* stop = nullptr;  ///< ends the wait for a calibration by hand
};

/// Empty if there is such a device (HandConfig::device); else a sentence that lists the devices.
std::string deviceComplaint(const std::string& device);
/// Opens the device. Throws Error, FileError and UsageError.
HandSource openHand(const HandConfig& config, const HandOpening& opening);

}  // namespace palpate
