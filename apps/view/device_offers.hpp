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

/// Asks the drivers and services of this machine, which may take seconds. `held`: the device in use by this program,
/// as in --device, whose driver is left alone; empty: none.
std::vector<DeviceOffer> devicesPluggedIn(const std::string& held);

}  // namespace palpate
