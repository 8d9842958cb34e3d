// What holds a HIP, as the command line says it.
#pragma once

#include "apps/cli/context.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct HandChoices {
  std::string option = "--device";  ///< that names the device
  std::string device = "path", map = "fit", passivity, scheduler = "device";
  double handStiffness_N_per_mm = 0, handDamping_N_s_per_mm = 0;  ///< 0: the simulation's own
  double duration_s = 0;                                          ///< 0: as long as the path
  bool rumble = false;                                            ///< of a gamepad, at each contact

  /// `path`: that a script or a simulated hand follows.
  HandConfig config(const std::string& path, double penetration_mm) const;
};
void addHandOptions(Options& command, HandChoices& options);
/// What a device may be, as a validator of an option.
Check deviceValidator();
/// Throws UsageError for what does not go together; before anything is loaded or opened.
void checkHandOptions(const HandChoices& options, bool realtime);
/// Those of a second hand with this device (--second-device): what is said of the first one's is said of it, too.
HandChoices secondHand(HandChoices options, const std::string& device);

}  // namespace palpate
