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

void addDriver(std::vector<DeviceOffer>& offers, const DriverFinding& driver, std::vector<DeviceOffer> visible) {
  if (driver.device) {
    const std::string& serial = driver.device->serial;
    offers.push_back({driver.option,
                      driver.device->model + (serial.empty() ? std::string() : ", serial number " + serial),
                      "is ready",
                      {}});
    return;
  }
  if (!driver.file.empty() && visible.empty()) visible.push_back({driver.option, driver.product, {}, {}});
  for (DeviceOffer& each : visible) {
    if (each.state.empty()) each.state = driver.problem;
    offers.push_back(std::move(each));
  }
}

}  // namespace

std::vector<DeviceOffer> devicesPluggedIn(const std::string& held) {
  std::vector<DeviceOffer> offers;
  for (const haply::Inverse& inverse : surveyHaply().inventory.inverses) {
    const std::string device = "haply:" + inverse.id;
    const bool isHeld = isOfKind(held, "haply") && (held == "haply" || held.starts_with(device));
    offers.push_back({device,
                      (inverse.small ? "Minverse " : "Inverse3 ") + inverse.id,
                      isHeld ? "in use here" : readinessOf(inverse),
                      {}});
  }
  const auto transport = hidapiTransport();
  const std::vector<HidCandidate> hids = hidCandidates(*transport);
  if (!isOfKind(held, "openhaptics")) addDriver(offers, surveyOpenHaptics(), styluses(hids));
  if (!isOfKind(held, "dhd")) addDriver(offers, surveyForceDimension(), {});
  for (const HidCandidate& hid : hids)
    if (hid.kind != HidKind::hapticStylus)
      offers.push_back({"hid:" + hid.info.path, hid.name,
                        hid.usable ? "steers a simulated hand; gives no force" : hid.whyNot, hid.mend});
  return offers;
}

}  // namespace palpate
