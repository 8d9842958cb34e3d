#include "apps/cli/hand_options.hpp"

#include "engine/core/error.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/hand_source.hpp"

namespace palpate {

HandConfig HandChoices::config(const std::string& path, double penetration_mm) const {
  HandConfig hand{.device = device,
                  .path = path,
                  .penetration_mm = penetration_mm,
                  .fit = map == "identity" ? WorkspaceFit::identity : WorkspaceFit::fit,
                  .stiffness_N_per_mm = handStiffness_N_per_mm,
                  .damping_N_s_per_mm = handDamping_N_s_per_mm,
                  .ownScheduler = scheduler == "own",
                  .rumbles = rumble};
  for (const auto& [name, mode] : kPassivityModes)
    if (passivity == name) hand.passivity = mode;
  return hand;
}

Check deviceValidator() { return {deviceComplaint, "DEVICE"}; }

void addHandOptions(Options& sub, HandChoices& options) {
  sub.add("--device", options.device,
          "source of the poses: path (a script, not moved by forces), sim (a simulated Geomagic Touch in a compliant "
          "hand), replay:FILE (a session log, trace or trajectory), or a device, with --realtime and --duration: " +
              heldDevicesHelp() + ". Button 1 of a stylus sculpts, button 2 is a clutch")
      .check(deviceValidator())
      .showDefault();
  sub.add("--scheduler", options.scheduler,
          "thread that runs the ticks of an OpenHaptics device: device (the driver) or own (palpate)")
      .check(oneOf({"device", "own"}))
      .showDefault();
  sub.add("--map", options.map,
          "fit: scale and centre the path (or the model, for a held device) into the workspace; "
          "identity: one to one, origins together")
      .check(oneOf({"fit", "identity"}))
      .showDefault();
  sub.add("--hand-stiffness", options.handStiffness_N_per_mm, "sim: stiffness of the hand, N/mm (default 0.4)")
      .check(between(bounds::kMinStiffness_N_per_mm, bounds::kMaxStiffness_N_per_mm));
  sub.add("--hand-damping", options.handDamping_N_s_per_mm, "sim: damping of the hand, N s/mm (default 0.002)")
      .check(between(bounds::kMinDamping_N_s_per_mm, bounds::kMaxDamping_N_s_per_mm));
  sub.add("--passivity", options.passivity,
          "when the surface gives more energy than it took: on (brake), observe (only count) or off "
          "(default: on for a device or sim, off for a path)")
      .check(oneOf({"on", "off", "observe"}));
  sub.addFlag("--rumble", options.rumble, "a DualSense on a cable rumbles at each contact, whatever the device");
}

void checkHandOptions(const HandChoices& options, bool realtime) {
  const bool held = isHeldDevice(options.device);
  if (options.rumble && !realtime) throw UsageError("--rumble requires --realtime");
  if (options.device != "sim" && (options.handStiffness_N_per_mm > 0 || options.handDamping_N_s_per_mm > 0))
    throw UsageError("--hand-stiffness and --hand-damping require --device sim");
  if (options.map != "fit" && options.device != "sim" && !held)
    throw UsageError("--map requires a device or sim: a path is in model units, and a recording has its own map");
  if (!held) return;
  if (!realtime) throw UsageError("{} {} requires --realtime", options.option, options.device);
  if (!(options.duration_s > 0)) throw UsageError("{} {} requires --duration", options.option, options.device);
}

HandChoices secondHand(HandChoices options, const std::string& device) {
  options.option = "--second-device";
  options.device = device;
  options.rumble = false;
  options.scheduler = "own";  // only the first hand's device may run the ticks
  if (device == "sim") return options;
  options.handStiffness_N_per_mm = options.handDamping_N_s_per_mm = 0;
  if (isHeldDevice(device)) return options;
  options.map = "fit";
  if (options.passivity == "on") options.passivity.clear();  // a script cannot be braked
  return options;
}

}  // namespace palpate
