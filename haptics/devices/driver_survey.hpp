// Surveys the haptic devices of a machine, to find out why none is usable.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptics/devices/haply_protocol.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/devices/vendor_library.hpp"

namespace palpate {

/// A device node that a driver needs.
struct NodeFinding {
  std::string path, what;
  bool usable = false;
  std::string mend;  ///< a command that makes it usable; empty if it is
};

/// Result for a vendor's driver.
struct DriverFinding {
  std::string product;                           ///< name of its library
  std::string file;                              ///< loaded library; empty if there is none
  std::vector<VendorLibrary::Attempt> attempts;  ///< failed ones before it
  std::vector<std::string> missing;              ///< functions that the library lacks
  std::optional<HapticDeviceFacts> device;       ///< first one, if it could be opened
  DeviceLimits limits;                           ///< of the device
  std::string problem;                           ///< what is wrong and what to do; empty if there is a device
  std::vector<NodeFinding> nodes;                ///< ports at which its devices appear
};

/// Loads the libraries and opens their first device briefly, without waiting for a manual calibration.
DriverFinding surveyOpenHaptics();
DriverFinding surveyForceDimension();

/// Result for the service of Haply devices.
struct HaplyFinding {
  std::uint16_t port = 0;
  std::string version;       ///< empty if it does not tell
  bool tellsEvents = false;  ///< it has the channel that tells a stop by the safety
  haply::Inventory inventory;
  std::string problem;  ///< what is wrong and what to do; empty if the service answers
};
/// Asks it for its devices, without a command to one.
HaplyFinding surveyHaply();
/// As a sentence without a subject: why a device gives no force, or that it is ready.
std::string readinessOf(const haply::Inverse& inverse);

/// The USB serial ports, as which a Touch appears.
std::vector<NodeFinding> surveySerialPorts();

/// Faults in this session's environment that affect the drivers, in words; empty if there are none.
std::vector<std::string> surveySurroundings();

}  // namespace palpate
