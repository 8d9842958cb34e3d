#include "apps/devices.hpp"

#include <charconv>

#include "engine/core/error.hpp"
#include "haptics/devices/force_dimension_device.hpp"
#include "haptics/devices/hid_choice.hpp"
#include "haptics/devices/hid_device.hpp"
#include "haptics/devices/rumbling_device.hpp"

namespace palpate {
namespace {

constexpr double kUsedShare = 0.9;  // of the workspace: the arms' last millimetres are not pleasant
constexpr std::string_view kOpenHaptics = "openhaptics", kForceDimension = "dhd", kHid = "hid";
constexpr double kFront = 0.48;  // of the workspace's depth, from its middle to where a pushed stylus begins

/// What follows the colon; nothing where `spec` is about another kind of device.
std::optional<std::string> argumentOf(const std::string& spec, std::string_view kind) {
  if (spec == kind) return std::string();
  if (spec.starts_with(kind) && spec[kind.size()] == ':') return spec.substr(kind.size() + 1);
  return std::nullopt;
}

int numberOf(const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0 || number > 63)
    throw UsageError("--device dhd:{}: the number of a device, from 0 on", text);
  return number;
}

HidRemark remarksTo(Log& log) {
  return [&log](std::string_view sentence) { log.say("{}", sentence); };
}

OpenedDevice openHid(const std::string& which, Log& log) {
  const auto transport = hidapiTransport();
  const HidInfo info = chooseHidSteering(*transport, which);
  auto device =
      std::make_unique<HidDevice>(transport, info, DVec3(0, 0, kFront * kTouchWorkspace_mm.z), remarksTo(log));
  log.say("the stylus is {} at {}", device->name(), info.path);
  return {.device = std::move(device),
          .facts = {.model = nameOf(info),
                    .serial = info.serial,
                    .workspaceMin_mm = -0.5 * kTouchWorkspace_mm,
                    .workspaceMax_mm = 0.5 * kTouchWorkspace_mm}};
}

}  // namespace

bool isHeldDevice(const std::string& spec) {
  for (const std::string_view kind : {kOpenHaptics, kForceDimension, kHid})
    if (argumentOf(spec, kind)) return true;
  return false;
}

std::string heldDevicesHelp() {
  return "openhaptics[:NAME], a Geomagic Touch or its kin, by the vendor's driver; dhd[:NUMBER], a Force Dimension; "
         "hid[:WHICH], a 3D mouse or a DualSense whose push steers a hand (its /dev/hidraw, serial number or VID:PID)";
}

OpenedDevice openDevice(const std::string& spec, Scheduler scheduler, double rate_Hz, Log& log,
                        const std::atomic<bool>* stop) {
  if (const auto name = argumentOf(spec, kOpenHaptics)) {
    auto device = std::make_unique<OpenHapticsDevice>(
        OpenHapticsOptions{.deviceName = *name,
                           .scheduler = scheduler,
                           .rate_Hz = rate_Hz,
                           .say = [&log](const std::string& words) { log.say("{}", words); },
                           .stop = stop});
    const HapticDeviceFacts facts = device->facts();
    return {std::move(device), facts};
  }
  if (const auto number = argumentOf(spec, kForceDimension)) {
    auto device = std::make_unique<ForceDimensionDevice>(number->empty() ? 0 : numberOf(*number));
    const HapticDeviceFacts facts = device->facts();
    return {std::move(device), facts};
  }
  if (const auto which = argumentOf(spec, kHid)) return openHid(*which, log);
  throw UsageError("--device {}: no device in a hand is called so; there is {}", spec, heldDevicesHelp());
}

std::unique_ptr<HapticDevice> withRumble(std::unique_ptr<HapticDevice> device, Log& log) {
  const auto transport = hidapiTransport();
  const HidInfo pad = chooseDualSense(*transport);
  auto rumble = std::make_unique<Rumble>(transport, pad, remarksTo(log), device->limits().peakForce_N);
  log.say("{} rumbles at each contact", nameOf(pad));
  return std::make_unique<RumblingDevice>(std::move(device), std::move(rumble));
}

WorkspaceMap mapInto(const HapticDeviceFacts& facts, const Model& model) {
  const Bounds bounds = boundsOf(model.cloud);
  const DVec3 room_mm = facts.workspaceMax_mm - facts.workspaceMin_mm;
  const DVec3 shares = (bounds.max - bounds.min) / (kUsedShare * room_mm);
  const double scale = std::max({model.scale.toUnits(1), shares.x, shares.y, shares.z});
  const DVec3 middle_mm = 0.5 * (facts.workspaceMin_mm + facts.workspaceMax_mm);
  return {.scale = scale, .offset = model.cloud.origin + bounds.center() - scale * middle_mm};
}

}  // namespace palpate
