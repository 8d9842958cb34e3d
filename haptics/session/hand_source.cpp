#include "haptics/session/hand_source.hpp"

#include <algorithm>

#include "haptics/builtin_path.hpp"
#include "haptics/devices/path_device.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/devices/simulated_touch.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/session_header.hpp"
#include "haptics/session_log.hpp"

namespace palpate {
namespace {

constexpr double kBeforePath_s = 0.5;  // the hand waits while forces ramp up
constexpr std::string_view kReplay = "replay:";

Path pathFor(const HandConfig& config, const Model& model) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (!config.path.starts_with(kBuiltin)) return readPathCsv(config.path);
  const std::string name = config.path.substr(kBuiltin.size());
  if (model.ballRadius() > 0)
    return builtinPathInMatter(
        name, {.fill = boundsOf(model.cloud), .up = directionOf(model.upright.up), .ballRadius = model.ballRadius()},
        model.scale, config.penetration_mm);
  return builtinPath(name, model.cloud, model.scale, config.penetration_mm);
}

HandSource simulated(const HandConfig& config, const Path& path, const ModelScale& scale) {
  const WorkspaceMap map =
      config.fit == WorkspaceFit::identity ? WorkspaceMap{.scale = scale.toUnits(1)} : workspaceAround(path, scale);
  SimulatedTouchOptions touch{.lead_s = kBeforePath_s};
  if (config.stiffness_N_per_mm > 0) touch.handStiffness_N_per_mm = config.stiffness_N_per_mm;
  if (config.damping_N_s_per_mm > 0) touch.handDamping_N_s_per_mm = config.damping_N_s_per_mm;
  auto device = std::make_unique<SimulatedTouch>(path, map, touch);
  const double duration_s = device->duration_s();
  return {.device = std::move(device), .map = map, .duration_s = duration_s};
}

HandSource replayed(const std::string& file, const Model& model, Log& log) {
  if (isSessionLog(file)) {
    SessionRecord record = readSessionLog(file);
    for (const std::string& sentence : whatIsMissing(record)) log.warn("{}: {}", file, sentence);
    if (record.ticks.empty()) throw FileError(file, "contains no complete tick, so it cannot be replayed");
    const RecordedSession session = parseHeader(file, record.text);
    const double duration_s = record.ticks.back().time_s;
    return {.device = std::make_unique<ReplayDevice>(std::move(record.ticks), session.limits),
            .map = session.map,
            .duration_s = duration_s,
            .passivity = session.passivity};
  }
  Trajectory trajectory = readTrajectory(file);
  const Bounds bounds = boundsOf(model.cloud);
  const DVec3 middle = model.cloud.origin + bounds.center();
  // A path that is far from the model in all samples was recorded with another model, or in other units.
  const auto isFar = [&](const TrajectorySample& sample) {
    return glm::distance(sample.position, middle) > 100 * bounds.longestSide();
  };
  if (std::ranges::all_of(trajectory.samples, isFar))
    throw FileError(file, "is never near the model; its positions must be in the units of the model's file");
  HandSource hand{.device = std::make_unique<PathDevice>(trajectory.path()),
                  .duration_s = trajectory.samples.back().t_s};
  if (trajectory.hasForces) hand.recorded = std::move(trajectory);
  return hand;
}

}  // namespace

std::string deviceComplaint(const std::string& device) {
  if (device == "path" || device == "sim" || device.starts_with(kReplay) || isHeldDevice(device)) return {};
  return fmt::format("'{}' is not a device; devices are path, sim, replay:FILE and {}", device, heldDevicesHelp());
}

HandSource openHand(const HandConfig& config, const HandOpening& opening) {
  const ModelScale& scale = opening.model.scale;
  HandSource hand;
  if (config.device == "sim") {
    hand = simulated(config, pathFor(config, opening.model), scale);
  } else if (config.device.starts_with(kReplay)) {
    hand = replayed(config.device.substr(kReplay.size()), opening.model, opening.log);
  } else if (isHeldDevice(config.device)) {
    OpenedDevice opened = openDevice(config.device, {.log = opening.log,
                                                     .rate_Hz = opening.rate_Hz,
                                                     .ownScheduler = config.ownScheduler,
                                                     .stop = opening.stop,
                                                     .axes = config.axes});
    hand = {.device = std::move(opened.device),
            .map = config.fit == WorkspaceFit::identity ? WorkspaceMap{.scale = scale.toUnits(1)}
                                                        : mapInto(opened.facts, opening.model),
            .remembered = std::move(opened.remembered)};
  } else if (config.device == "path") {
    Path path = pathFor(config, opening.model);
    const double duration_s = path.duration_s();
    hand = {.device = std::make_unique<PathDevice>(std::move(path)), .duration_s = duration_s};
  } else {
    throw ConfigError("hands.device", "{}", deviceComplaint(config.device));
  }
  if (config.rumbles) hand.device = withRumble(std::move(hand.device), opening.log);
  if (config.passivity) hand.passivity = config.passivity;
  return hand;
}

}  // namespace palpate
