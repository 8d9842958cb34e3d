// Options for the source of a HIP's poses.
#pragma once

#include "apps/cli/context.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct HandChoices {
  std::string option = "--device";  ///< option that names the device
  std::string device = "path", scheduler = "device";
  HandConfig hand;        ///< mapping, passivity, simulated hand, rumbling
  double duration_s = 0;  ///< 0: that of the path

  /// `path`: for a script or a simulated hand.
  HandConfig config(const std::string& path, double penetration_mm) const;
};
void addHandOptions(Options& command, HandChoices& options);
/// Validator for the name of a device.
Check deviceValidator();
/// Throws UsageError for incompatible options; before anything is loaded or opened.
void checkHandOptions(const HandChoices& options, bool realtime);
/// Options of a second hand with this device (--second-device): those of the first hand, as far as they apply.
HandChoices secondHand(HandChoices options, const std::string& device);

}  // namespace palpate
