#include "apps/cli/doctor_device.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/core/error.hpp"
#include "haptics/session/devices.hpp"

namespace palpate {
namespace {

constexpr std::chrono::milliseconds kTick{1};
constexpr int kTicks = 200;  // timeout for the first pose

const char* yesNo(bool yes) { return yes ? "yes" : "no"; }

/// Permissions that concern the devices of `spec`.
Json permissionsFor(std::FILE* out, const std::string& spec) {
  Mending mending;
  for (const DeviceOffer& offer : surveyKindOf(spec).offers) mending.add(offer.mend);
  return mending.print(out);
}

/// After some ticks without a force.
DeviceState poseOf(HapticDevice& device) {
  DeviceState state;
  int tick = 0;
  const auto once = [&] {
    state = device.read(1e-3 * tick);
    return device.write(DVec3(0)) && state.ok && ++tick < kTicks;
  };
  if (device.paces()) {
    device.pace(1000, once);
    return state;
  }
  while (once()) std::this_thread::sleep_for(kTick);
  return state;
}

}  // namespace

void Mending::add(const std::string& command) {
  if (!command.empty() && std::ranges::find(commands_, command) == commands_.end()) commands_.push_back(command);
}

Json Mending::print(std::FILE* out) const {
  if (!commands_.empty()) fmt::print(out, "To grant missing permissions:\n");
  for (const std::string& command : commands_) fmt::print(out, "  {}\n", command);
  return commands_;
}

Json haplyService(std::FILE* out, const HaplyFinding& found) {
  const bool answers = found.problem.empty();
  fmt::print(out, "--device haply: Haply service\n");
  Json json{{"answers", answers},      {"port", found.port},       {"version", found.version},
            {"reason", found.problem}, {"devices", Json::array()}, {"grips", Json::array()}};
  if (!answers) {
    fmt::print(out, "  not usable: {}\n", found.problem);
    return json;
  }
  fmt::print(out, "  version {} at 127.0.0.1:{}{}\n", found.version.empty() ? "unknown" : found.version, found.port,
             found.tellsEvents ? "" : ", no event channel");
  if (found.inventory.inverses.empty()) fmt::print(out, "  no Inverse3; check its cable and power supply\n");
  for (const haply::Inverse& inverse : found.inventory.inverses) {
    const char* model = inverse.small ? "Minverse" : "Inverse3";
    const std::string readiness = readinessOf(inverse);
    fmt::print(out, "  {}, serial number {}, firmware {}, {} hand, axes {}: {}\n", model, inverse.id,
               inverse.firmware.empty() ? "unknown" : inverse.firmware, inverse.handedness, inverse.permutation,
               readiness);
    json["devices"].push_back({{"model", model},
                               {"serial", inverse.id},
                               {"firmware", inverse.firmware},
                               {"handedness", inverse.handedness},
                               {"axes", inverse.permutation},
                               {"calibrated", inverse.calibrated},
                               {"power_supply", inverse.powered},
                               {"in_use", inverse.inUse},
                               {"state", readiness}});
  }
  for (const haply::Grip& grip : found.inventory.grips) {
    fmt::print(out, "  {} grip {}: connected: {}{}\n", grip.wireless ? "wireless" : "wired", grip.id,
               yesNo(grip.connected), grip.battery ? fmt::format(", battery {:.0f} %", 100 * *grip.battery) : "");
    json["grips"].push_back({{"serial", grip.id},
                             {"wireless", grip.wireless},
                             {"connected", grip.connected},
                             {"battery", grip.battery ? Json(*grip.battery) : Json(nullptr)}});
  }
  return json;
}

Json examineDevice(std::FILE* out, const std::string& spec, Log& log) {
  OpenedDevice opened;
  try {
    opened = openDevice(spec, {.log = log});
  } catch (const Error&) {
    permissionsFor(out, spec);
    throw;
  }
  const HapticDeviceFacts& facts = opened.facts;
  const DeviceLimits limits = opened.device->limits();
  const DVec3 low = facts.workspaceMin_mm, high = facts.workspaceMax_mm;
  const DeviceState state = poseOf(*opened.device);
  if (!state.ok) throw Error("{}", opened.device->faultText());
  const auto known = [](const std::string& text) { return text.empty() ? "not reported by the device" : text.c_str(); };
  fmt::print(out, "{}\n", spec);
  fmt::print(out, "  model           {}\n  serial number   {}\n  driver          {}\n", facts.model,
             known(facts.serial), known(facts.driver));
  fmt::print(out,
             "  workspace       right {:.0f} to {:.0f}, up {:.0f} to {:.0f}, towards the user {:.0f} to {:.0f} mm\n",
             low.x, high.x, low.y, high.y, low.z, high.z);
  fmt::print(out, "  force           at most {:.3g} N, {:.3g} N continuously\n", limits.peakForce_N,
             limits.continuousForce_N);
  fmt::print(out, "  buttons         {}\n  hand            {}\n  axes            {}\n", limits.buttons,
             known(facts.handedness), known(facts.axes));
  if (!facts.grip.empty())
    fmt::print(out, "  grip            {}{}\n", facts.grip,
               facts.battery ? fmt::format(", battery {:.0f} %", 100 * *facts.battery) : "");
  fmt::print(out, "  remembered      {}\n", opened.remembered.isEmpty() ? "nothing" : opened.remembered.inWords());
  fmt::print(out, "  stylus          at {:.1f}, {:.1f}, {:.1f} mm; {}\n", state.position.x, state.position.y,
             state.position.z, state.rendersForce ? "ready to give forces" : "not ready to give forces");
  if (state.rendersForce)
    fmt::print(out, "Next: palpate view MODEL --device {} lets you feel a model with it.\n", spec);
  Json json{{"device", spec},
            {"model", facts.model},
            {"serial", facts.serial},
            {"driver", facts.driver},
            {"workspace_min_mm", vectorJson(low)},
            {"workspace_max_mm", vectorJson(high)},
            {"peak_force_N", limits.peakForce_N},
            {"continuous_force_N", limits.continuousForce_N},
            {"buttons", limits.buttons},
            {"handedness", facts.handedness},
            {"axes", facts.axes},
            {"remembered", opened.remembered.inWords()},
            {"position_mm", vectorJson(state.position)},
            {"renders_force", state.rendersForce}};
  json["fix"] = permissionsFor(out, spec);
  return json;
}

}  // namespace palpate
