#include "haptics/session/devices.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>

#include "engine/core/error.hpp"
#include "haptics/devices/force_dimension_device.hpp"
#include "haptics/devices/haply_device.hpp"
#include "haptics/devices/hid_choice.hpp"
#include "haptics/devices/hid_device.hpp"
#include "haptics/devices/openhaptics_device.hpp"
#include "haptics/devices/personal_device.hpp"
#include "haptics/devices/rumbling_device.hpp"

namespace palpate {
namespace {

constexpr double kUsedShare = 0.9;  // of the workspace: the last millimetres of the arms are unpleasant
constexpr double kFront = 0.48;     // of the workspace's depth: from its middle to the start of a steered stylus

/// The text after the colon; empty optional if `spec` is another kind of device.
std::optional<std::string> argumentOf(const std::string& spec, std::string_view kind) {
  if (spec == kind) return std::string();
  if (spec.starts_with(kind) && spec[kind.size()] == ':') return spec.substr(kind.size() + 1);
  return std::nullopt;
}

int numberOf(const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0 || number > 63)
    throw ConfigError("hands.device", "dhd:{}: is not the number of a device, 0 to 63", text);
  return number;
}

HidRemark remarksTo(Log& log) {
  return [&log](std::string_view sentence) { log.say("{}", sentence); };
}

template <class Device>
OpenedDevice withFacts(std::unique_ptr<Device> device) {
  OpenedDevice opened;
  opened.facts = device->facts();
  opened.device = std::move(device);
  return opened;
}

OpenedDevice openHid(const std::string& which, const DeviceOpening& opening) {
  const auto transport = hidapiTransport();
  const HidInfo info = chooseHidSteering(*transport, which);
  auto device =
      std::make_unique<HidDevice>(transport, info, DVec3(0, 0, kFront * kTouchWorkspace_mm.z), remarksTo(opening.log));
  opening.log.say("the stylus is {} at {}", device->name(), info.path);
  OpenedDevice opened;
  opened.device = std::move(device);
  opened.facts = {.model = nameOf(info),
                  .serial = info.serial,
                  .workspaceMin_mm = -0.5 * kTouchWorkspace_mm,
                  .workspaceMax_mm = 0.5 * kTouchWorkspace_mm};
  return opened;
}

OpenedDevice openOpenHaptics(const std::string& name, const DeviceOpening& opening) {
  auto device = std::make_unique<OpenHapticsDevice>(
      OpenHapticsOptions{.deviceName = name,
                         .scheduler = opening.ownScheduler ? Scheduler::own : Scheduler::device,
                         .rate_Hz = opening.rate_Hz,
                         .say = [&log = opening.log](const std::string& words) { log.say("{}", words); },
                         .stop = opening.stop});
  return withFacts(std::move(device));
}

OpenedDevice openForceDimension(const std::string& number, const DeviceOpening&) {
  return withFacts(std::make_unique<ForceDimensionDevice>(number.empty() ? 0 : numberOf(number)));
}

OpenedDevice openHaply(const std::string& which, const DeviceOpening& opening) {
  constexpr std::string_view kShared = "shared";
  HaplyOptions options{.serial = which,
                       .say = [&log = opening.log](const std::string& words) { log.say("{}", words); }};
  const std::size_t colon = which.rfind(':');
  const std::size_t word = colon == std::string::npos ? 0 : colon + 1;
  if (which.substr(word) == kShared) {
    options.shares = true;
    options.serial.resize(colon == std::string::npos ? 0 : colon);
  }
  return withFacts(std::make_unique<HaplyDevice>(options));
}

/// A kind of held device.
struct HeldDevice {
  std::string_view name, help;
  OpenedDevice (*open)(const std::string& which, const DeviceOpening& opening);  ///< the one named after the colon
  DeviceSurvey (*survey)(const std::string& kind, const std::optional<std::string>& held);
  bool steers = false;
};
constexpr auto kHeldDevices = std::to_array<HeldDevice>({
    {"openhaptics", "[:NAME] (Geomagic Touch and compatible, with the driver of the vendor)", openOpenHaptics,
     driverDevices<surveyOpenHaptics, visibleStyluses>},
    {"dhd", "[:NUMBER] (Force Dimension)", openForceDimension, driverDevices<surveyForceDimension>},
    {"haply", "[:SERIAL][:shared] (Haply Inverse3 and VerseGrip, with Haply's service; shared: beside another program)",
     openHaply, haplyDevices},
    {"hid", "[:WHICH] (3D mouse or DualSense that steers a hand; WHICH: /dev/hidraw*, serial number or VID:PID)",
     openHid, hidDevices, true},
});

/// Null if `spec` names no held device.
const HeldDevice* kindOf(const std::string& spec) {
  const auto found = std::ranges::find_if(
      kHeldDevices, [&](const HeldDevice& kind) { return argumentOf(spec, kind.name).has_value(); });
  return found == kHeldDevices.end() ? nullptr : &*found;
}

/// What is remembered for the device. If that cannot be read, the device is used without it.
RememberedDevice recall(const OpenedDevice& opened, const DeviceOpening& opening) {
  if (opened.key.empty()) return {};
  try {
    return opening.memory.find(opened.key);
  } catch (const Error& error) {
    opening.log.warn("{}", error.what());
    return {};
  }
}

/// Gives the device the axes and the largest stiffness of its user, and says so.
void personalize(OpenedDevice& opened, const DeviceOpening& opening) {
  opened.remembered = recall(opened, opening);
  const std::string& wanted = opening.axes.empty() ? opened.remembered.axes : opening.axes;
  if (!wanted.empty()) {
    const auto axes = DeviceAxes::named(wanted);
    if (!axes) throw ConfigError("hands.axes", "{}", axesComplaint(wanted));
    opened.axes = *axes;
  }
  if (!opened.remembered.isEmpty())
    opening.log.say("{}: {}, as remembered; palpate doctor --device {} --forget removes that", opened.facts.model,
                    opened.remembered.inWords(), opened.key);
  const double unlimited = std::numeric_limits<double>::infinity();
  const double most = opened.remembered.stiffness_N_per_mm.value_or(unlimited);
  if (opened.axes.isUnchanged() && most == unlimited) return;
  const glm::dmat3 toPerson = opened.axes.matrix();
  const DVec3 a = toPerson * opened.facts.workspaceMin_mm, b = toPerson * opened.facts.workspaceMax_mm;
  opened.facts.workspaceMin_mm = glm::min(a, b);
  opened.facts.workspaceMax_mm = glm::max(a, b);
  opened.device = std::make_unique<PersonalDevice>(std::move(opened.device), opened.axes, most);
}

}  // namespace

bool isHeldDevice(const std::string& spec) { return kindOf(spec) != nullptr; }

bool isSteering(const std::string& spec) {
  const HeldDevice* kind = kindOf(spec);
  return kind && kind->steers;
}

std::vector<std::string> heldDeviceNames(std::vector<std::string> before) {
  for (const HeldDevice& kind : kHeldDevices) before.emplace_back(kind.name);
  return before;
}

std::vector<DeviceSurvey> surveyDevices(const std::string& held) {
  std::vector<DeviceSurvey> found;
  found.reserve(std::size(kHeldDevices));
  for (const HeldDevice& kind : kHeldDevices)
    found.push_back(kind.survey(std::string(kind.name), argumentOf(held, kind.name)));
  return found;
}

DeviceSurvey surveyKindOf(const std::string& held) {
  const HeldDevice* kind = kindOf(held);
  return kind ? kind->survey(std::string(kind->name), argumentOf(held, kind->name)) : DeviceSurvey();
}

std::string heldDevicesHelp() {
  std::string help;
  for (const HeldDevice& kind : kHeldDevices)
    help += fmt::format("{}{}{}", help.empty() ? "" : "; ", kind.name, kind.help);
  return help;
}

OpenedDevice openDevice(const std::string& spec, const DeviceOpening& opening) {
  const HeldDevice* kind = kindOf(spec);
  if (!kind)
    throw ConfigError("hands.device", "'{}' is not a device for a hand; devices are {}", spec, heldDevicesHelp());
  OpenedDevice opened = kind->open(*argumentOf(spec, kind->name), opening);
  opened.key = deviceKey(kind->name, opened.facts.serial);
  opened.limits = opened.device->limits();
  personalize(opened, opening);
  return opened;
}

std::unique_ptr<HapticDevice> withRumble(std::unique_ptr<HapticDevice> device, Log& log) {
  const auto transport = hidapiTransport();
  const HidInfo pad = chooseDualSense(*transport);
  auto rumble = std::make_unique<Rumble>(transport, pad, remarksTo(log), device->limits().peakForce_N);
  log.say("{} rumbles at each contact", nameOf(pad));
  return std::make_unique<RumblingDevice>(std::move(device), std::move(rumble));
}

WorkspaceMap mapInto(const HapticDeviceFacts& facts, const Model& model) {
  const Bounds bounds = model.shownBounds();
  const DVec3 room_mm = facts.workspaceMax_mm - facts.workspaceMin_mm;
  const DVec3 shares = (bounds.max - bounds.min) / (kUsedShare * room_mm);
  const double scale = std::max({model.scale.toUnits(1), shares.x, shares.y, shares.z});
  const DVec3 middle_mm = 0.5 * (facts.workspaceMin_mm + facts.workspaceMax_mm);
  return {.scale = scale, .offset = model.cloud.origin + bounds.center() - scale * middle_mm};
}

}  // namespace palpate
