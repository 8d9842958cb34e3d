// palpate doctor --device NAME --test
#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include "apps/cli/doctor_device.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "engine/core/error.hpp"
#include "haptics/device_check.hpp"
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

void printAxes(std::FILE* out, const DeviceCheckResult& result) {
  static constexpr std::array<const char*, 3> kAsked{"right", "up", "towards the user"};
  static constexpr std::array<const char*, 7> kMoved{"away from the user", "down", "left", "", "right", "up",
                                                     "towards the user"};
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = result.axes[k];
    fmt::print(out, "  moved {:<16}  {}\n", kAsked[k],
               axis == 0 ? "not seen"
               : axis == static_cast<int>(k) + 1
                   ? "as the hand"
                   : fmt::format("the stylus moved {}", kMoved[static_cast<std::size_t>(axis + 3)]));
  }
  const bool isKnown = std::ranges::find(result.axes, 0) == result.axes.end();
  if (isKnown && !result.axesAreRight())
    fmt::print(out,
               "  Turn the device towards the user, or correct its axes and handedness in the vendor's software.\n");
}

void print(std::FILE* out, const DeviceCheckResult& result) {
  fmt::print(
      out, "free space\n  poses             {:.0f} per second, {:.0f} % differ from the one before\n",
      result.freeSpace_s > 0 ? static_cast<double>(result.poses - 1) / result.freeSpace_s : 0,
      100.0 * static_cast<double>(result.changedPoses) / static_cast<double>(std::max<std::uint64_t>(1, result.poses)));
  fmt::print(out, "  largest gap       {:.1f} ms\n  noise             {:.3f} mm\n  force             {:.3g} N\n",
             1e3 * result.largestGap_s, result.noise_mm, result.freeForce_N);
  fmt::print(out, "directions\n");
  printAxes(out, result);
  fmt::print(out, "wall\n  peak force        {:.2f} N\n", result.peakForce_N);
  if (result.oscillated) fmt::print(out, "  hum               stopped after {:.0f} ms\n", 1e3 * result.oscillation_s);
  if (const auto offered = result.offeredStiffness_N_per_mm())
    fmt::print(out, "  stable            up to {:.2f} N/mm{}\n  recommended       --stiffness {:.2f}\n",
               *result.stableStiffness_N_per_mm, result.oscillated ? "" : " at least", *offered);
  else
    fmt::print(out, "  stable            unknown: {}\n",
               result.triedStiffness_N_per_mm > 0 ? "each wall hummed, or the contact was too short"
                                                  : "the stylus did not press on the wall");
}

}  // namespace

Json guideDeviceCheck(std::FILE* out, const std::string& spec, Log& log) {
  if (spec == "hid" || spec.starts_with("hid:"))
    throw UsageError("--test: {} steers a simulated hand; the test requires a device with force feedback", spec);
  const StopBySignal signals;
  const OpenedDevice opened = openDevice(spec, {.log = log, .stop = &StopBySignal::requested()});
  const DeviceCheckOptions options{.stop = &StopBySignal::requested()};
  DeviceCheckQuery query(options, opened.device->limits());
  fmt::print(out, "{}, serial number {}. Ctrl+C ends the test.\n", opened.facts.model,
             opened.facts.serial.empty() ? "unknown" : opened.facts.serial);
  DeviceCheckResult result;
  {
    const std::jthread guiding([&](const std::stop_token& end) { guide(out, query, end); });
    result = checkDevice(*opened.device, query);
  }
  if (!result.fault.empty()) throw Error("{}", result.fault);
  print(out, result);
  const auto offered = result.offeredStiffness_N_per_mm();
  return {{"device", spec},
          {"serial", opened.facts.serial},
          {"poses", result.poses},
          {"changed_poses", result.changedPoses},
          {"free_space_s", result.freeSpace_s},
          {"largest_gap_s", result.largestGap_s},
          {"noise_mm", result.noise_mm},
          {"free_force_N", result.freeForce_N},
          {"axes", {result.axes[0], result.axes[1], result.axes[2]}},
          {"peak_force_N", result.peakForce_N},
          {"oscillated", result.oscillated},
          {"oscillation_s", result.oscillation_s},
          {"least_energy_mJ", result.leastEnergy_mJ},
          {"stable_stiffness_N_per_mm",
           result.stableStiffness_N_per_mm ? Json(*result.stableStiffness_N_per_mm) : Json(nullptr)},
          {"recommended_stiffness_N_per_mm", offered ? Json(*offered) : Json(nullptr)}};
}

}  // namespace palpate
