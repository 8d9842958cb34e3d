// What holds the HIP: a script or a model of a hand on a haptic device, and the options that say so.
#pragma once

#include "apps/context.hpp"
#include "haptics/haptic_device.hpp"
#include "haptics/passivity.hpp"
#include "haptics/path.hpp"

namespace palpate {

struct StylusOptions {
  std::string device = "path", map = "fit", passivity;
  double handStiffness_N_per_mm = 0, handDamping_N_s_per_mm = 0;  ///< 0: the simulation's own
  double duration_s = 0;                                          ///< 0: as long as the path
};
void addStylusOptions(CLI::App& command, StylusOptions& options);

struct Stylus {
  std::unique_ptr<HapticDevice> device;
  WorkspaceMap map;
  double duration_s = 0;
  std::optional<PassivityMode> passivity;
};
/// Throws UsageError for what does not go together.
Stylus makeStylus(const StylusOptions& options, Path path, const ModelScale& scale);

}  // namespace palpate
