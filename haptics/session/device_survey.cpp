#include "haptics/session/device_survey.hpp"

namespace palpate {

namespace {

std::vector<HidCandidate> hids() {
  const auto transport = hidapiTransport();
  return hidCandidates(*transport);
}

}  // namespace

bool isStylus(const HidCandidate& hid) { return hid.kind == HidKind::hapticStylus; }

std::vector<DeviceOffer> visibleStyluses(const std::string& kind) {
  std::vector<DeviceOffer> found;
  for (const HidCandidate& hid : hids())
    if (isStylus(hid)) found.push_back({kind, hid.name, hid.whyNot, hid.mend});
  for (const NodeFinding& node : surveySerialPorts())
    if (!node.usable) found.push_back({kind, node.path, "no permission for this user", node.mend});
  return found;
}

DeviceSurvey driverDevices(const std::string& kind, DriverFinding (*find)(), std::vector<DeviceOffer> visible) {
  const DriverFinding driver = find ? find() : DriverFinding{.problem = "in use here"};
  DeviceSurvey survey{.kind = kind, .finding = driver};
  if (driver.device) {
    const std::string& serial = driver.device->serial;
    survey.offers.push_back(
        {kind, driver.device->model + (serial.empty() ? "" : ", serial number " + serial), "is ready", {}});
    return survey;
  }
  if (!driver.file.empty() && visible.empty()) visible.push_back({kind, driver.product, {}, {}});
  for (DeviceOffer& each : visible)
    if (each.state.empty()) each.state = driver.problem;
  if (visible.empty() && find) survey.missing = driver.problem;
  survey.offers = std::move(visible);
  return survey;
}

DeviceSurvey haplyDevices(const std::string& kind, const std::optional<std::string>& held) {
  HaplyFinding haply = surveyHaply();
  DeviceSurvey survey{.kind = kind};
  for (const haply::Inverse& inverse : haply.inventory.inverses)
    survey.offers.push_back(
        {kind + ":" + inverse.id,
         (inverse.small ? "Minverse " : "Inverse3 ") + inverse.id,
         held && (held->empty() || held->starts_with(inverse.id)) ? "in use here" : readinessOf(inverse),
         {}});
  if (survey.offers.empty())
    survey.missing =
        haply.problem.empty() ? "the Haply service has no Inverse3; check its cable and power supply" : haply.problem;
  survey.finding = std::move(haply);
  return survey;
}

DeviceSurvey hidDevices(const std::string& kind, const std::optional<std::string>&) {
  DeviceSurvey survey{.kind = kind, .finding = hids()};
  for (const HidCandidate& hid : std::get<std::vector<HidCandidate>>(survey.finding))
    if (!isStylus(hid))
      survey.offers.push_back({kind + ":" + hid.info.path, hid.name,
                               hid.usable ? "steers a simulated hand; gives no force" : hid.whyNot, hid.mend});
  return survey;
}

}  // namespace palpate
