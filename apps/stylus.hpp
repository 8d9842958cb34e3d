// What holds the HIP: a person at a haptic device, a script, a recording, or a model of a hand; and the options that
// say so.
#pragma once

#include "apps/devices.hpp"
#include "haptics/passivity.hpp"
#include "haptics/path.hpp"
#include "haptics/trajectory.hpp"

namespace palpate {

struct StylusOptions {
  std::string option = "--device";  ///< that names the device
  std::string device = "path", map = "fit", passivity, scheduler = "device";
  double handStiffness_N_per_mm = 0, handDamping_N_s_per_mm = 0;  ///< 0: the simulation's own
  double duration_s = 0;                                          ///< 0: as long as the path
  bool rumble = false;                                            ///< of a gamepad, at each contact
};
void addStylusOptions(CLI::App& command, StylusOptions& options);
/// What `device` may be, as a validator of an option.
CLI::Validator deviceValidator();
/// Throws UsageError for what does not go together; before anything is loaded or opened.
void checkStylusOptions(const StylusOptions& options, bool realtime);
/// Those of a second hand with this device (--second-device): what is said of the first one's is said of it, too.
StylusOptions secondStylus(StylusOptions options, const std::string& device);

struct Stylus {
  std::unique_ptr<HapticDevice> device;
  WorkspaceMap map;
  double duration_s = 0;
  std::optional<PassivityMode> passivity;
  std::optional<Trajectory> recorded;  ///< with the forces of then, where a trajectory is replayed
};

/// What a stylus is made for.
struct StylusFor {
  const Model& model;
  std::function<Path()> path;  ///< asked for where a script or a simulated hand follows it
  double rate_Hz = 1000;
  Log& log;
  const std::atomic<bool>* stop = nullptr;
};
/// Opens the device. Throws Error, FileError and UsageError.
Stylus makeStylus(const StylusOptions& options, const StylusFor& wanted);

}  // namespace palpate
