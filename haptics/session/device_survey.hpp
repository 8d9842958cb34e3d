// What is plugged in of each kind of held device. The rows of kHeldDevices (devices.cpp) name these functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptics/devices/driver_survey.hpp"
#include "haptics/devices/hid_choice.hpp"

namespace palpate {

struct DeviceOffer {
  std::string device;  ///< as in --device
  std::string name, state;
  std::string mend;  ///< a command that grants a missing permission; empty: none is missing
};

/// A stylus over HID steers nothing by itself: the driver of 3D Systems opens it.
bool isStylus(const HidCandidate& hid);

/// What was found of one kind.
struct DeviceSurvey {
  std::string kind;                 ///< as in --device
  std::vector<DeviceOffer> offers;  ///< for a choice among them
  std::string missing;              ///< why there is none, and what to do; empty: nothing is expected
  std::variant<DriverFinding, HaplyFinding, std::vector<HidCandidate>> finding;
};

// Ask the drivers and services of this machine, which may take seconds. `held`: the device of this kind that this
// program uses, as after the colon in --device; its driver is left alone.

DeviceSurvey haplyDevices(const std::string& kind, const std::optional<std::string>& held);
DeviceSurvey hidDevices(const std::string& kind, const std::optional<std::string>& held);
/// Devices of 3D Systems that are visible without their driver, and what keeps a user from them.
std::vector<DeviceOffer> visibleStyluses(const std::string& kind);
inline std::vector<DeviceOffer> noneVisible(const std::string&) { return {}; }
/// Of a vendor's driver. Null: it is in use here.
DeviceSurvey driverDevices(const std::string& kind, DriverFinding (*find)(), std::vector<DeviceOffer> visible);
template <DriverFinding (*find)(), std::vector<DeviceOffer> (*visible)(const std::string&) = noneVisible>
DeviceSurvey driverDevices(const std::string& kind, const std::optional<std::string>& held) {
  return driverDevices(kind, held ? nullptr : find, visible(kind));
}

}  // namespace palpate
