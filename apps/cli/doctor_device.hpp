// What `palpate doctor` finds out about haptic devices one by one.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "apps/cli/json.hpp"
#include "engine/core/log.hpp"
#include "haptics/devices/hid_choice.hpp"

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

/// A stylus over HID steers nothing by itself: the driver of 3D Systems opens it.
bool isStylus(const HidCandidate& hid);

/// The service of Haply devices, its devices and grips.
Json haplyService(std::FILE* out);

/// Opens a held device, without a force, and describes it. If that fails, prints the missing permissions and throws.
Json examineDevice(std::FILE* out, const std::string& spec, Log& log);

/// Opens a held device and guides a person through the device test, in sentences (checkDevice()). Throws Error if the
/// device cannot be opened or fails.
Json guideDeviceCheck(std::FILE* out, const std::string& spec, Log& log);

}  // namespace palpate
