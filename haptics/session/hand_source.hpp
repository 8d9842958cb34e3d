// What holds a HIP: a person at a haptic device, a script, a recording, or a model of a hand.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "haptics/devices/haptic_device.hpp"
#include "haptics/passivity.hpp"
#include "haptics/session/model.hpp"
#include "haptics/trajectory.hpp"

namespace palpate {

/// A hand of a session, as it is run with; the device is somebody else's.
struct OpenHand {
  HapticDevice* device = nullptr;
  WorkspaceMap map;
  double duration_s = 0;  ///< of its path or recording; 0 where it has no end of its own
  std::optional<PassivityMode> passivity;
};

/// A hand that is ready to touch, with its device.
struct HandSource {
  std::unique_ptr<HapticDevice> device;
  WorkspaceMap map;
  double duration_s = 0;  ///< of its path or recording; 0 where it has no end of its own
  std::optional<PassivityMode> passivity;
  std::optional<Trajectory> recorded;  ///< with the forces of then, where a trajectory is replayed

  OpenHand hand() const { return {device.get(), map, duration_s, passivity}; }
};

struct HandOpening {
  const Model& model;
  double rate_Hz = 1000;
  Log& log;
  const std::atomic<bool>* stop = nullptr;  ///< ends the wait for a person who has to calibrate a device
};

/// Whether there is such a device (HandConfig::device); otherwise a sentence that lists those that there are.
std::string deviceComplaint(const std::string& device);
/// Opens the device. Throws Error, FileError and UsageError.
HandSource openHand(const HandConfig& config, const HandOpening& opening);

}  // namespace palpate
