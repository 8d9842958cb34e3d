#include "apps/stylus.hpp"

#include "engine/core/error.hpp"
#include "haptics/path_device.hpp"
#include "haptics/simulated_touch.hpp"

namespace palpate {
namespace {

constexpr double kBeforePath_s = 0.5;  // forces ramp up for so long; the hand waits for them

std::optional<PassivityMode> passivityMode(const std::string& name) {
  if (name == "on") return PassivityMode::on;
  if (name == "observe") return PassivityMode::observe;
  if (name == "off") return PassivityMode::off;
  return std::nullopt;
}

Stylus simulated(const StylusOptions& options, Path path, const ModelScale& scale) {
  const WorkspaceMap map =
      options.map == "identity" ? WorkspaceMap{.scale = scale.toUnits(1)} : workspaceAround(path, scale);
  SimulatedTouchOptions touch{.lead_s = kBeforePath_s};
  if (options.handStiffness_N_per_mm > 0) touch.handStiffness_N_per_mm = options.handStiffness_N_per_mm;
  if (options.handDamping_N_s_per_mm > 0) touch.handDamping_N_s_per_mm = options.handDamping_N_s_per_mm;
  auto device = std::make_unique<SimulatedTouch>(std::move(path), map, touch);
  const double duration_s = device->duration_s();
  return {.device = std::move(device), .map = map, .duration_s = duration_s};
}

}  // namespace

void addStylusOptions(CLI::App& sub, StylusOptions& options) {
  sub.add_option(
         "--device", options.device,
         "what moves the HIP: path, a script that nothing holds up; or sim, a simulated Geomagic Touch in a hand "
         "that follows the path and yields to the force (it waits half a second while forces ramp up)")
      ->check(CLI::IsMember({"path", "sim"}))
      ->capture_default_str();
  sub.add_option(
         "--map", options.map,
         "how the device's millimetres meet the model's: fit, the path in the middle of the workspace and shrunk "
         "if it is too large; or identity, with the origins together")
      ->check(CLI::IsMember({"fit", "identity"}))
      ->capture_default_str();
  sub.add_option("--hand-stiffness", options.handStiffness_N_per_mm, "of the simulated hand, N/mm (default 0.4)")
      ->check(positive());
  sub.add_option("--hand-damping", options.handDamping_N_s_per_mm, "of the simulated hand, N s/mm (default 0.002)")
      ->check(positive());
  sub.add_option("--passivity", options.passivity,
                 "what to do when the surface gives more energy than it took: on, brake; observe, count only; off "
                 "(default: on where a hand yields to the force, off for a script, which cannot be braked)")
      ->check(CLI::IsMember({"on", "off", "observe"}));
  sub.add_option("--duration", options.duration_s, "of the session, s (default: as long as the path)")
      ->check(positive());
}

Stylus makeStylus(const StylusOptions& options, Path path, const ModelScale& scale) {
  Stylus stylus;
  if (options.device == "sim") {
    stylus = simulated(options, std::move(path), scale);
  } else {
    if (options.handStiffness_N_per_mm > 0 || options.handDamping_N_s_per_mm > 0)
      throw UsageError("--hand-stiffness and --hand-damping: a path has no hand; they need --device sim");
    if (options.map != "fit") throw UsageError("--map: a path is in the model's own units; it needs --device sim");
    const double duration_s = path.duration_s();
    stylus = {.device = std::make_unique<PathDevice>(std::move(path)), .duration_s = duration_s};
  }
  if (options.duration_s > 0) stylus.duration_s = options.duration_s;
  stylus.passivity = passivityMode(options.passivity);
  return stylus;
}

}  // namespace palpate
