// What a machine has of haptic devices, for one who wants to know why there is none.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptics/devices/haptic_device.hpp"
#include "haptics/devices/vendor_library.hpp"

namespace palpate {

/// A vendor's driver, as it was found.
struct DriverFinding {
  std::string option;                            ///< of --device
  std::string product;                           ///< whose library
  std::string file;                              ///< that was loaded; empty while there is none
  std::vector<VendorLibrary::Attempt> attempts;  ///< that failed before
  std::vector<std::string> missing;              ///< functions that the library has not
  std::optional<HapticDeviceFacts> device;       ///< that could be opened
  DeviceLimits limits;                           ///< of the device
  std::string problem;                           ///< in words, with what to do; empty where there is a device
};

/// Loads the libraries and opens their first device for a moment; without waiting for a person to calibrate it.
DriverFinding surveyOpenHaptics();
DriverFinding surveyForceDimension();

/// A device node that a driver needs.
struct NodeFinding {
  std::string path, what;
  bool usable = false;
  std::string mend;  ///< a command; empty where it is usable
};
/// The serial ports over USB, as which a Touch shows itself.
std::vector<NodeFinding> surveySerialPorts();

/// What of this session's surroundings troubles the drivers, in words; empty where nothing does.
std::vector<std::string> surveySurroundings();

}  // namespace palpate
