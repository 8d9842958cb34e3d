// palpate doctor --device NAME --test
#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <string>
#include <thread>

#include "apps/cli/doctor_device.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "engine/core/error.hpp"
#include "haptics/device_check.hpp"
#include "haptics/session/device_memory.hpp"
#include "haptics/session/devices.hpp"

namespace palpate {
namespace {

/// Prints what the person is to do, and how stiff the wall is, while the test runs.
void guide(std::FILE* out, const DeviceCheckQuery& query, const std::stop_token& end) {
  constexpr std::chrono::milliseconds kLook{20};
  auto said = DeviceCheckStage::done;
  double stiffness_N_per_mm = 0;
  for (; !end.stop_requested(); std::this_thread::sleep_for(kLook)) {
    const DeviceCheckStage stage = query.stage();
    if (stage != said) fmt::print(out, "{}\n", instructionOf(stage));
    if (stage == DeviceCheckStage::lean && query.stiffness_N_per_mm() >= 1.1 * stiffness_N_per_mm) {
      stiffness_N_per_mm = query.stiffness_N_per_mm();
      fmt::print(out, "  wall: {:.2f} N/mm\n", stiffness_N_per_mm);
    }
    said = stage;
    std::fflush(out);
  }
}

std::string movedText(const DeviceCheckResult& result, std::size_t k) {
  static constexpr std::array<const char*, 7> kMoved{"away from the user", "down", "left", "", "right", "up",
                                                     "towards the user"};
  const int axis = result.axes[k];
  if (axis == 0) return "not seen";
  if (axis == static_cast<int>(k) + 1) return "as the hand";
  return fmt::format("the stylus moved {}", kMoved.at(static_cast<std::size_t>(axis) + 3));
}

std::string axesText(const DeviceCheckResult& result) {
  if (result.axesAreRight()) return "right";
  const auto axes = result.offeredAxes();
  if (!axes) return "unknown, since not all directions were seen";
  return fmt::format("--axes {}{}", axes->text(),
                     axes->mirrors() ? ", mirrored, as of a device set up for the other hand" : "");
}

void print(std::FILE* out, const DeviceCheckResult& result) {
  fmt::print(out, "result\n");
  for (const auto& [name, text] : deviceCheckRows(result)) fmt::print(out, "  {:<16}  {}\n", name, text);
}

/// Yes or no, from the terminal; no at the end of the input.
bool agrees(std::FILE* out, const std::string& question) {
  fmt::print(out, "{} [y/N] ", question);
  std::fflush(out);
  std::string answer;
  if (!std::getline(std::cin, answer)) fmt::print(out, "\n");
  return answer == "y" || answer == "Y" || answer == "yes";
}

/// Asks for each finding whether sessions shall use it from now on.
void offer(std::FILE* out, const DeviceCheckResult& result, const OpenedDevice& opened) {
  const auto stiffness = result.offeredStiffness_N_per_mm();
  const auto axes = result.offeredAxes();
  if (!stiffness && !axes) return;
  if (opened.key.empty()) {
    fmt::print(out, "The device reports no serial number, so nothing can be remembered for it.\n");
    return;
  }
  RememberedDevice wanted = opened.remembered;
  wanted.model = opened.facts.model;
  if (stiffness &&
      agrees(out, fmt::format("Use a stiffness of {:.2f} N/mm with {} from now on, and never a larger one?", *stiffness,
                              opened.key)))
    wanted.stiffness_N_per_mm = stiffness;
  if (const auto all = axes ? std::optional(axes->after(opened.axes)) : std::nullopt;
      all && agrees(out, fmt::format("Use the axes {} with {} from now on?", all->text(), opened.key)))
    wanted.axes = all->isUnchanged() ? std::string() : all->text();
  if (wanted == opened.remembered || (wanted.isEmpty() && opened.remembered.isEmpty())) return;
  const DeviceMemory memory;
  memory.remember(opened.key, wanted);
  fmt::print(out, "Remembered in {}; palpate doctor --device {} --forget removes it.\n", memory.file().string(),
             opened.key);
}

Json toJson(const DeviceCheckResult& result) {
  const auto offered = result.offeredStiffness_N_per_mm();
  const auto axes = result.offeredAxes();
  return {{"poses", result.poses},
          {"changed_poses", result.changedPoses},
          {"free_space_s", result.freeSpace_s},
          {"largest_gap_s", result.largestGap_s},
          {"noise_mm", result.noise_mm},
          {"free_force_N", result.freeForce_N},
          {"axes", {result.axes[0], result.axes[1], result.axes[2]}},
          {"recommended_axes", axes ? Json(axes->text()) : Json(nullptr)},
          {"peak_force_N", result.peakForce_N},
          {"oscillated", result.oscillated},
          {"oscillation_s", result.oscillation_s},
          {"least_energy_mJ", result.leastEnergy_mJ},
          {"stable_stiffness_N_per_mm",
           result.stableStiffness_N_per_mm ? Json(*result.stableStiffness_N_per_mm) : Json(nullptr)},
          {"recommended_stiffness_N_per_mm", offered ? Json(*offered) : Json(nullptr)}};
}

}  // namespace

std::vector<std::pair<std::string, std::string>> deviceCheckRows(const DeviceCheckResult& result) {
  const double poses = static_cast<double>(std::max<std::uint64_t>(1, result.poses));
  std::vector<std::pair<std::string, std::string>> rows{
      {"poses", fmt::format("{:.0f} per second, {:.0f} % differ from the one before",
                            result.freeSpace_s > 0 ? (poses - 1) / result.freeSpace_s : 0,
                            100.0 * static_cast<double>(result.changedPoses) / poses)},
      {"largest gap", fmt::format("{:.1f} ms", 1e3 * result.largestGap_s)},
      {"noise", fmt::format("{:.3f} mm", result.noise_mm)},
      {"force in the air", fmt::format("{:.3g} N", result.freeForce_N)},
      {"moved right", movedText(result, 0)},
      {"moved up", movedText(result, 1)},
      {"moved towards", movedText(result, 2)},
      {"axes", axesText(result)},
      {"peak force", fmt::format("{:.2f} N", result.peakForce_N)}};
  if (result.oscillated) rows.emplace_back("hum", fmt::format("stopped after {:.0f} ms", 1e3 * result.oscillation_s));
  if (const auto offered = result.offeredStiffness_N_per_mm()) {
    rows.emplace_back("stable", fmt::format("up to {:.2f} N/mm{}", *result.stableStiffness_N_per_mm,
                                            result.oscillated ? "" : " at least"));
    rows.emplace_back("recommended", fmt::format("--stiffness {:.2f}", *offered));
  } else {
    rows.emplace_back("stable", result.triedStiffness_N_per_mm > 0
                                    ? "unknown: each wall hummed, or the contact was too short"
                                    : "unknown: the stylus did not press on the wall");
  }
  return rows;
}

Json guideDeviceCheck(std::FILE* out, const std::string& spec, Log& log) {
  if (isSteering(spec))
    throw UsageError("--test: {} steers a simulated hand; the test requires a device with force feedback", spec);
  OpenedDevice opened;
  DeviceCheckResult result;
  {
    const StopBySignal signals;
    opened = openDevice(spec, {.log = log, .stop = &StopBySignal::requested()});
    DeviceCheckQuery query({.stop = &StopBySignal::requested()}, opened.limits);
    fmt::print(out, "{}, serial number {}. Ctrl+C ends the test.\n", opened.facts.model,
               opened.facts.serial.empty() ? "unknown" : opened.facts.serial);
    const std::jthread guiding([&](const std::stop_token& end) { guide(out, query, end); });
    result = checkDevice(*opened.device, query);
    opened.device.reset();  // closed before questions are asked
  }
  if (!result.fault.empty()) throw Error("{}", result.fault);
  print(out, result);
  if (!StopBySignal::requested()) offer(out, result, opened);
  Json json = toJson(result);
  json["device"] = spec;
  json["serial"] = opened.facts.serial;
  return json;
}

Json rememberedDevices(std::FILE* out) {
  const DeviceMemory memory;
  Json json{{"file", memory.file().string()}, {"window", ""}, {"devices", Json::array()}, {"reason", ""}};
  try {
    const auto devices = memory.devices();
    for (const auto& [key, device] : devices) {
      fmt::print(out, "Remembered for {} ({}): {}\n", key, device.model, device.inWords());
      json["devices"].push_back(
          {{"device", key},
           {"model", device.model},
           {"stiffness_N_per_mm", device.stiffness_N_per_mm ? Json(*device.stiffness_N_per_mm) : Json(nullptr)},
           {"axes", device.axes}});
    }
    const std::string chosen = memory.chosen();
    const bool isDevice = !chosen.empty() && chosen != "mouse";
    if (isDevice) fmt::print(out, "The window uses the device that it used last: {}\n", chosen);
    json["window"] = chosen;
    if (isDevice || !devices.empty())
      fmt::print(out, "  palpate doctor --device NAME --forget removes that from {}\n", memory.file().string());
  } catch (const Error& error) {
    fmt::print(out, "{}\n", error.what());
    json["reason"] = error.what();
  }
  return json;
}

Json forgetDevice(std::FILE* out, const std::string& spec) {
  const DeviceMemory memory;
  const std::vector<std::string> forgotten = memory.forget(spec);
  for (const std::string& key : forgotten) fmt::print(out, "{}: forgotten\n", key);
  if (forgotten.empty())
    fmt::print(out, "nothing was remembered for {}; palpate doctor lists the devices that are remembered\n", spec);
  return forgotten;
}

}  // namespace palpate
