// Options for the source of a HIP's poses.
#pragma once

#include "apps/cli/context.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct HandChoices {
  std::string option = "--device";  ///< option that names the device
  std::string device = "path", map = "fit", passivity, scheduler = "device";
  double handStiffness_N_per_mm = 0, handDamping_N_s_per_mm = 0;  ///< 0: the simulation's default
  double duration_s = 0;                                          ///< 0: that of the path
  bool rumble = false;                                            ///< a gamepad rumbles at each contact

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
