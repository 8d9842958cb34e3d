#include "apps/stylus.hpp"

#include "apps/session_text.hpp"
#include "engine/core/error.hpp"
#include "haptics/devices/path_device.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/devices/simulated_touch.hpp"

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

constexpr std::string_view kReplay = "replay:";

Stylus replayed(const std::string& file, const Model& model, Log& log) {
  if (isSessionLog(file)) {
    SessionRecord record = readSessionLog(file);
    for (const std::string& sentence : whatIsMissing(record)) log.say("{}: {}", file, sentence);
    if (record.ticks.empty()) throw FileError(file, "has no whole tick; there is nothing to replay");
    const RecordedSession session = parseSessionText(file, record.text);
    const double duration_s = record.ticks.back().time_s;
    return {.device = std::make_unique<ReplayDevice>(std::move(record.ticks), session.limits),
            .map = session.map,
            .duration_s = duration_s,
            .passivity = session.passivity};
  }
  Trajectory trajectory = readTrajectory(file);
  const Bounds bounds = boundsOf(model.cloud);
  const DVec3 middle = model.cloud.origin + bounds.center();
  // What is far from the model in all samples was recorded with another one, or in other units.
  const auto isFar = [&](const TrajectorySample& sample) {
    return glm::distance(sample.position, middle) > 100 * bounds.longestSide();
  };
  if (std::ranges::all_of(trajectory.samples, isFar))
    throw FileError(file, "goes nowhere near the model: its positions are taken in the units of the model's file");
  Stylus stylus{.device = std::make_unique<PathDevice>(trajectory.path()), .duration_s = trajectory.samples.back().t_s};
  if (trajectory.hasForces) stylus.recorded = std::move(trajectory);
  return stylus;
}

std::string deviceComplaint(const std::string& device) {
  if (device == "path" || device == "sim" || device.starts_with(kReplay) || isHeldDevice(device)) return {};
  return fmt::format("'{}' is no device; there is path, sim, replay:FILE and {}", device, heldDevicesHelp());
}

}  // namespace

CLI::Validator deviceValidator() { return {deviceComplaint, "DEVICE"}; }

void addStylusOptions(CLI::App& sub, StylusOptions& options) {
  sub.add_option("--device", options.device,
                 "what moves the HIP: path, a script that nothing holds up; sim, a simulated Geomagic Touch in a hand "
                 "that follows the path and yields to the force (it waits half a second while forces ramp up); "
                 "replay:FILE, a session log, a trace or a trajectory; or a device in a hand, with --realtime and "
                 "--duration: " +
                     heldDevicesHelp() + ". Button 1 of a stylus sculpts, button 2 is a clutch")
      ->check(deviceValidator())
      ->capture_default_str();
  sub.add_option("--scheduler", options.scheduler,
                 "who calls the ticks of an OpenHaptics device: device, its driver; or own, palpate")
      ->check(CLI::IsMember({"device", "own"}))
      ->capture_default_str();
  sub.add_option(
         "--map", options.map,
         "how the device's millimetres meet the model's: fit, the path (or the model, for a device in a hand) in the "
         "middle of the workspace and shrunk if it is too large; or identity, with the origins together")
      ->check(CLI::IsMember({"fit", "identity"}))
      ->capture_default_str();
  sub.add_option("--hand-stiffness", options.handStiffness_N_per_mm, "of the simulated hand, N/mm (default 0.4)")
      ->check(between(bounds::kLeastStiffness_N_per_mm, bounds::kMostStiffness_N_per_mm));
  sub.add_option("--hand-damping", options.handDamping_N_s_per_mm, "of the simulated hand, N s/mm (default 0.002)")
      ->check(between(1e-9, bounds::kMostDamping_N_s_per_mm));
  sub.add_option("--passivity", options.passivity,
                 "what to do when the surface gives more energy than it took: on, brake; observe, count only; off "
                 "(default: on where a hand yields to the force, off for a script, which cannot be braked)")
      ->check(CLI::IsMember({"on", "off", "observe"}));
  sub.add_flag("--rumble", options.rumble, "a DualSense on a cable rumbles at each contact, whatever the device");
}

void checkStylusOptions(const StylusOptions& options, bool realtime) {
  const bool held = isHeldDevice(options.device);
  if (options.rumble && !realtime) throw UsageError("--rumble: a gamepad rumbles in real time; add --realtime");
  if (options.device != "sim" && (options.handStiffness_N_per_mm > 0 || options.handDamping_N_s_per_mm > 0))
    throw UsageError("--hand-stiffness and --hand-damping: only --device sim has a hand that is simulated");
  if (options.map != "fit" && options.device != "sim" && !held)
    throw UsageError("--map: a path is in the model's own units, and a recording knows its map; it needs a device");
  if (!held) return;
  if (!realtime) throw UsageError("{} {}: a person lives in real time; add --realtime", options.option, options.device);
  if (!(options.duration_s > 0))
    throw UsageError("{} {}: has no path that ends; say how long with --duration", options.option, options.device);
}

StylusOptions secondStylus(StylusOptions options, const std::string& device) {
  options.option = "--second-device";
  options.device = device;
  options.rumble = false;
  options.scheduler = "own";  // the ticks are the first one's
  if (device == "sim") return options;
  options.handStiffness_N_per_mm = options.handDamping_N_s_per_mm = 0;
  if (isHeldDevice(device)) return options;
  options.map = "fit";
  if (options.passivity == "on") options.passivity.clear();  // a script cannot be braked
  return options;
}

Stylus makeStylus(const StylusOptions& options, const StylusFor& wanted) {
  const ModelScale& scale = wanted.model.scale;
  Stylus stylus;
  if (options.device == "sim") {
    stylus = simulated(options, wanted.path(), scale);
  } else if (options.device.starts_with(kReplay)) {
    stylus = replayed(options.device.substr(kReplay.size()), wanted.model, wanted.log);
  } else if (isHeldDevice(options.device)) {
    const Scheduler scheduler = options.scheduler == "own" ? Scheduler::own : Scheduler::device;
    OpenedDevice opened = openDevice(options.device, scheduler, wanted.rate_Hz, wanted.log, wanted.stop);
    stylus = {.device = std::move(opened.device),
              .map = options.map == "identity" ? WorkspaceMap{.scale = scale.toUnits(1)}
                                               : mapInto(opened.facts, wanted.model)};
  } else {
    Path path = wanted.path();
    const double duration_s = path.duration_s();
    stylus = {.device = std::make_unique<PathDevice>(std::move(path)), .duration_s = duration_s};
  }
  if (options.rumble) stylus.device = withRumble(std::move(stylus.device), wanted.log);
  if (options.duration_s > 0) stylus.duration_s = options.duration_s;
  if (!options.passivity.empty()) stylus.passivity = passivityMode(options.passivity);
  return stylus;
}

}  // namespace palpate
