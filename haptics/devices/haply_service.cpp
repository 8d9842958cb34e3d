#include "haptics/devices/haply_service.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "haptics/devices/system_devices.hpp"

namespace palpate {
namespace {

constexpr double kFirst_s = 2, kAsk_s = 0.5;

std::string listOf(const std::vector<haply::Inverse>& inverses) {
  std::string list;
  for (const haply::Inverse& inverse : inverses)
    list += fmt::format("{}haply:{} ({} hand{})", list.empty() ? "" : ", ", inverse.id, inverse.handedness,
                        inverse.inUse ? ", in use" : "");
  return list;
}

HaplyLink connected(const haply::Ports& ports) try { return HaplyLink(ports.simulation); } catch (const Error& error) {
  throw Error("haply: the Haply service does not answer ({}); install it from Haply, and start it: {}", error.what(),
              haplyStart());
}

}  // namespace

HaplyService::HaplyService() : ports(haply::servicePorts()), link(connected(ports)) {
  const HaplyLink::Heard heard = link.hear(kFirst_s, first);
  if (heard == HaplyLink::Heard::closed)
    throw Error("haply: the Haply service closes the connection before it lists its devices; start it again");
  if (heard == HaplyLink::Heard::nothing)
    throw Error("haply: the Haply service accepts connections but lists no devices; start it again");
  auto found = haply::inventoryIn(first);
  if (!found) throw Error("haply: the Haply service's first message is not JSON; update the service");
  inventory = std::move(*found);
  for (const std::uint16_t port : ports.http)
    for (const char* path : {"/version", "/3.1/version", "/3.0/version"})
      if (version.empty())
        if (const auto answer = askHaplyService(port, path, kAsk_s)) version = haply::versionIn(*answer);
  try {
    events = std::make_unique<HaplyLink>(ports.events);
  } catch (const Error&) {
    events.reset();
  }
}

const haply::Inverse& HaplyService::device(const std::string& serial, bool shares) const {
  const std::vector<haply::Inverse>& all = inventory.inverses;
  if (all.empty())
    throw Error("haply: the Haply service has no Inverse3; check its cable and power supply, and the Haply Hub");
  if (serial.empty() && all.size() > 1)
    throw Error("haply: there are {} devices; choose one by its serial number: {}", all.size(), listOf(all));
  const auto chosen = serial.empty() ? all.begin() : std::ranges::find(all, serial, &haply::Inverse::id);
  if (chosen == all.end()) throw Error("haply: no device '{}' is connected; devices are {}", serial, listOf(all));
  if (chosen->inUse && !shares)
    throw Error(
        "haply: another program uses {}, and the forces of both would add up; close it, or use it nevertheless: "
        "haply:{}:shared",
        chosen->id, chosen->id);
  return *chosen;
}

const haply::Grip* HaplyService::gripOf(const haply::Inverse& inverse) const {
  const auto place = &inverse - inventory.inverses.data();
  const haply::Grip* grip = nullptr;
  std::ptrdiff_t count = 0;
  for (const haply::Grip& one : inventory.grips)
    if (one.connected && count++ <= place) grip = &one;
  return grip;
}

}  // namespace palpate
