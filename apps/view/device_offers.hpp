// The haptic devices that are plugged in, for a choice among them.
#pragma once

#include <string>
#include <vector>

namespace palpate {

struct DeviceOffer {
  std::string device;  ///< as in --device
  std::string name, state;
  std::string mend;  ///< a command that grants a missing permission; empty: none is missing
};

/// A kind of device of which none was found.
struct MissingKind {
  std::string kind;    ///< as in --device
  std::string reason;  ///< what is missing and what to do
};

struct DevicesFound {
  std::vector<DeviceOffer> offers;
  std::vector<MissingKind> missing;
};

/// Asks the drivers and services of this machine, which may take seconds. `held`: the device in use by this program,
/// as in --device, whose driver is left alone; empty: none.
DevicesFound devicesPluggedIn(const std::string& held);

}  // namespace palpate
