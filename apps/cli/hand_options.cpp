#include "apps/cli/hand_options.hpp"

#include "apps/cli/setting_options.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/hand_source.hpp"

namespace palpate {

HandConfig HandChoices::config(const std::string& path, double penetration_mm) const {
  HandConfig config = hand;
  config.device = device;
  config.path = path;
  config.penetration_mm = penetration_mm;
  config.ownScheduler = scheduler == "own";
  return config;
}

Check deviceValidator() { return {deviceComplaint, "DEVICE"}; }

void addHandOptions(Options& sub, HandChoices& options) {
  addSettingFor<HandConfig>(sub, options.device, "device")
      .describe(fmt::format("{}: {}. Button 1 of a stylus sculpts, button 2 is a clutch",
                            settingNamed<HandConfig>("device").help, heldDevicesHelp()))
      .check(deviceValidator())
      .offers({"path", "sim", "replay:", "openhaptics", "dhd", "haply", "hid"})
      .showDefault();
  addSettingFor<HandConfig>(sub, options.scheduler, "own_scheduler").check(oneOf({"device", "own"})).showDefault();
  addSetting(sub, options.hand, "fit").showDefault();
  addSetting(sub, options.hand, "stiffness_N_per_mm");
  addSetting(sub, options.hand, "damping_N_s_per_mm");
  addSetting(sub, options.hand, "passivity");
  addSetting(sub, options.hand, "rumbles");
}

void checkHandOptions(const HandChoices& options, bool realtime) {
  const bool held = isHeldDevice(options.device);
  if (options.hand.rumbles && !realtime) throw UsageError("--rumble requires --realtime");
  if (options.device != "sim" && (options.hand.stiffness_N_per_mm > 0 || options.hand.damping_N_s_per_mm > 0))
    throw UsageError("--hand-stiffness and --hand-damping require --device sim");
  if (options.hand.fit != WorkspaceFit::fit && options.device != "sim" && !held)
    throw UsageError("--map requires a device or sim: a path is in model units, and a recording has its own map");
  if (!held) return;
  if (!realtime) throw UsageError("{} {} requires --realtime", options.option, options.device);
  if (!(options.duration_s > 0)) throw UsageError("{} {} requires --duration", options.option, options.device);
}

HandChoices secondHand(HandChoices options, const std::string& device) {
  options.option = "--second-device";
  options.device = device;
  options.hand.rumbles = false;
  options.scheduler = "own";  // only the first hand's device may run the ticks
  if (device == "sim") return options;
  options.hand.stiffness_N_per_mm = options.hand.damping_N_s_per_mm = 0;
  if (isHeldDevice(device)) return options;
  options.hand.fit = WorkspaceFit::fit;
  if (options.hand.passivity == PassivityMode::on) options.hand.passivity.reset();  // a script cannot be braked
  return options;
}

}  // namespace palpate
