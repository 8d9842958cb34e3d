#include "apps/view/device_offers.hpp"

#include <algorithm>

#include "haptics/devices/driver_survey.hpp"
#include "haptics/devices/hid_choice.hpp"

namespace palpate {

namespace {

bool isOfKind(const std::string& device, std::string_view kind) {
  return device == kind || (device.starts_with(kind) && device.substr(kind.size()).starts_with(':'));
}

/// Devices of 3D Systems that are visible without their driver, and what keeps a user from them.
std::vector<DeviceOffer> styluses(const std::vector<HidCandidate>& hids) {
  std::vector<DeviceOffer> found;
  for (const HidCandidate& hid : hids)
    if (hid.kind == HidKind::hapticStylus) found.push_back({"openhaptics", hid.name, hid.whyNot, hid.mend});
  for (const NodeFinding& node : surveySerialPorts())
    if (!node.usable) found.push_back({"openhaptics", node.path, "no permission for this user", node.mend});
  return found;
}

void addDriver(DevicesFound& found, const DriverFinding& driver, std::vector<DeviceOffer> visible) {
  if (driver.device) {
    const std::string& serial = driver.device->serial;
    found.offers.push_back({driver.option,
                            driver.device->model + (serial.empty() ? std::string() : ", serial number " + serial),
                            "is ready",
                            {}});
    return;
  }
  if (!driver.file.empty() && visible.empty()) visible.push_back({driver.option, driver.product, {}, {}});
  for (DeviceOffer& each : visible) {
    if (each.state.empty()) each.state = driver.problem;
    found.offers.push_back(std::move(each));
  }
  if (visible.empty()) found.missing.push_back({driver.option, driver.problem});
}

void addHaply(DevicesFound& found, const std::string& held) {
  const HaplyFinding haply = surveyHaply();
  for (const haply::Inverse& inverse : haply.inventory.inverses) {
    const std::string device = "haply:" + inverse.id;
    const bool isHeld = isOfKind(held, "haply") && (held == "haply" || held.starts_with(device));
    found.offers.push_back({device,
                            (inverse.small ? "Minverse " : "Inverse3 ") + inverse.id,
                            isHeld ? "in use here" : readinessOf(inverse),
                            {}});
  }
  if (haply.inventory.inverses.empty())
    found.missing.push_back({"haply", haply.problem.empty()
                                          ? "the Haply service has no Inverse3; check its cable and power supply"
                                          : haply.problem});
}

}  // namespace

DevicesFound devicesPluggedIn(const std::string& held) {
  DevicesFound found;
  addHaply(found, held);
  const auto transport = hidapiTransport();
  const std::vector<HidCandidate> hids = hidCandidates(*transport);
  if (!isOfKind(held, "openhaptics")) addDriver(found, surveyOpenHaptics(), styluses(hids));
  if (!isOfKind(held, "dhd")) addDriver(found, surveyForceDimension(), {});
  for (const HidCandidate& hid : hids)
    if (hid.kind != HidKind::hapticStylus)
      found.offers.push_back({"hid:" + hid.info.path, hid.name,
                              hid.usable ? "steers a simulated hand; gives no force" : hid.whyNot, hid.mend});
  return found;
}

}  // namespace palpate
