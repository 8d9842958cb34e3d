// What `palpate doctor` finds out about haptic devices one by one.
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/json.hpp"
#include "engine/core/log.hpp"
#include "haptics/device_check.hpp"
#include "haptics/devices/driver_survey.hpp"

namespace palpate {

/// Collects the commands that grant missing permissions, each once.
class Mending {
 public:
  void add(const std::string& command);
  /// Prints them under a heading, if there are any.
  Json print(std::FILE* out) const;

 private:
  std::vector<std::string> commands_;
};

/// The service of Haply devices, its devices and grips.
Json haplyService(std::FILE* out, const HaplyFinding& found);

/// Opens a held device, without a force, and describes it. If that fails, prints the missing permissions and throws.
Json examineDevice(std::FILE* out, const std::string& spec, Log& log);

/// What the device test found: names and texts, for the terminal and the window's panel.
std::vector<std::pair<std::string, std::string>> deviceCheckRows(const DeviceCheckResult& result);

/// Opens a held device and guides a person through the device test, in sentences (checkDevice()); then asks whether
/// what was found is to be remembered for the device. Throws Error if the device cannot be opened or fails.
Json guideDeviceCheck(std::FILE* out, const std::string& spec, Log& log);

/// The devices for which something is remembered, and the window's.
Json rememberedDevices(std::FILE* out);
/// Forgets a device, as in haply:049D, or all of a kind.
Json forgetDevice(std::FILE* out, const std::string& spec);

}  // namespace palpate
