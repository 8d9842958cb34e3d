#include "apps/cli/touch.hpp"

#include "apps/cli/setting_options.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "haptics/builtin_path.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

void addEditOptions(Options& sub, TouchCommandOptions& options) {
  addSettingFor<BrushConfig>(sub, options.edit, "kind")
      .check(oneOf(choicesOf<BrushConfig>("kind", {"none"})))
      .showDefault();
  addSettings(sub, options.brush, {"tau_mm", "beta", "strength"});
  addSetting(sub, options.brush, "falloff").typeName("F").showDefault();
  addSettings(sub, options.brush, {"color", "keeps_density", "radius_mm"});
  addSetting(sub, options.undo, "undo").typeName("N");
  addSetting(sub, options.undo, "redo").typeName("M");
  addSetting(sub, options.undo, "memory_MiB").showDefault();
}

std::vector<std::string> builtinPaths() {
  std::vector<std::string> paths{"builtin:stir"};
  for (const std::string_view name : builtinPathNames()) paths.push_back(fmt::format("builtin:{}", name));
  return paths;
}

void addPathOptions(Options& sub, TouchCommandOptions& options) {
  addSettingFor<HandConfig>(sub, options.path, "path").offers(builtinPaths(), ".csv").showDefault();
  addSettingFor<HandConfig>(sub, options.penetration_mm, "penetration_mm").showDefault();
  addSetting(sub, options.session, "rate_Hz").showDefault();
  addSetting(sub, options.session, "realtime");
  addSettingFor<SessionConfig>(sub, options.hand.duration_s, "duration_s");
}

void addOutputOptions(Options& sub, TouchCommandOptions& options) {
  sub.add("--trace", options.traceFile, "one row per tick; its two wall-clock columns are 0 in virtual time")
      .typeName("FILE.csv");
  sub.add("--picture", options.pictureFile,
          "picture of the model at the end with HIP, proxy disc and force arrow, .png or .jpg")
      .typeName("IMG.png");
  sub.add("--save", options.saveFile,
          "write the edited points with all their properties; faces and other elements are dropped. An "
          "existing file that palpate did not write, or that holds more, is kept as OUT.ply.bak")
      .typeName("OUT.ply");
  sub.add("--log", options.logFile,
          "record poses, forces and edits for palpate replay; what is recorded survives a crash")
      .typeName("SESSION");
  sub.add("--trajectory", options.trajectoryFile,
          "time, position (model units) and force (N) of each tick: comma-separated with a header in a "
          ".csv, else blank-separated without one")
      .typeName("FILE");
  addSettingFor<BackendConfig>(sub, options.backend.timePasses, "times_passes");
}

void addSecondOptions(Options& sub, TouchCommandOptions& options) {
  sub.add("--second-device", options.secondDevice,
          "device of a second hand, which feels the same model and does not sculpt (vulkan with the "
          "method fused, or cpu); values as for --device")
      .check(deviceValidator());
  sub.add("--second-path", options.secondPath,
          "path of the second hand, for --second-device path and sim; values as for --path")
      .offers(builtinPaths(), ".csv")
      .typeName("PATH");
  sub.add("--second-trace", options.secondTraceFile, "trace of the second hand, as --trace").typeName("FILE.csv");
}

void checkSecondOptions(const TouchCommandOptions& options) {
  const std::string& device = options.secondDevice;
  if (device.empty()) {
    if (!options.secondPath.empty()) throw UsageError("--second-path: there is no second hand; add --second-device");
    if (!options.secondTraceFile.empty())
      throw UsageError("--second-trace: there is no second hand; add --second-device");
    return;
  }
  checkHandOptions(secondHand(options.hand, device), options.session.realtime);
  if (isHeldDevice(device) && device == options.hand.device)
    throw UsageError("--second-device: {} is in the first hand; name another one, as in openhaptics:NAME", device);
  const bool followsPath = device == "path" || device == "sim";
  if (followsPath && options.secondPath.empty())
    throw UsageError("--second-device {}: say where it goes with --second-path", device);
  if (!followsPath && !options.secondPath.empty())
    throw UsageError("--second-path: {} follows none; it is for path and sim", device);
  if (!options.logFile.empty())
    throw UsageError(
        "--log: a session log has one hand; leave it or --second-device out (--second-trace keeps a trace)");
}

}  // namespace

void addTouchOptions(Options& command, TouchCommandOptions& options) {
  // In the order in which a new user needs them.
  const auto heading = [&](const char* text) { command.heading(text); };
  heading("Model");
  addModelOptions(command, options.model, modelsAndStreams(), false);
  heading("Path");
  addPathOptions(command, options);
  heading("Contact and force");
  addSettings(command, options.force, {"stiffness_N_per_mm", "damping_N_s_per_mm", "max_N", "max_surface_power_W"});
  addSurfaceOptions(command, options.backend);
  heading("Sculpting");
  addEditOptions(command, options);
  heading("Output");
  addOutputOptions(command, options);
  heading("Picture");
  addPictureOptions(command, options.picture);
  heading("Motion");
  addMotionOptions(command, options.motion);
  heading("Depth camera");
  addStreamOptions(command, options.stream);
  heading("Shared session");
  addJoinOptions(command, options.join, JoinAs::hand);
  addRosOptions(command, options.join.ros);
  heading("Back end");
  addBackendOptions(command, options.backend);
  heading("Tool");
  addToolOptions(command, options.backend);
  heading("Devices");
  addHandOptions(command, options.hand);
  heading("Second hand");
  addSecondOptions(command, options);
  heading("Options");
  command.helpShows(
      {"--mm-per-unit", "--normals",  "--path",        "--penetration",  "--rate",      "--realtime", "--duration",
       "--stiffness",   "--damping",  "--max-force",   "--surface",      "--friction",  "--radius",   "--edit",
       "--tau",         "--strength", "--paint-color", "--tool-radius",  "--undo",      "--trace",    "--picture",
       "--save",        "--log",      "--up",          "--size",         "--camera",    "--color",    "--motion",
       "--live",        "--fuse",     "--join",        "--near",         "--interface", "--backend",  "--tool",
       "--tool-size",   "--device",   "--map",         "--second-device"});
}

void checkTouchOptions(const TouchCommandOptions& options, const TouchCapabilities& can) {
  checkPictureOptions(options.picture);
  checkHandOptions(options.hand, options.session.realtime);
  checkSecondOptions(options);
  if (options.edit == "none") {
    if (!options.saveFile.empty() && options.stream.fuse != "on" && options.join.name.empty() &&
        !sceneNamed(options.model.file))
      throw UsageError("--save: nothing changes with --edit none");
    if (options.undo.undo > 0) throw UsageError("--undo: nothing changes with --edit none");
  }
  if (options.undo.redo > 0 && options.undo.undo == 0)
    throw UsageError("--redo: only what --undo took back can be done again");
  if (options.picture.printFrame && options.pictureFile.empty()) throw UsageError("--print-frame: needs --picture");
  if (!options.logFile.empty())
    Abilities(ModelKind::cloud, can, options.backend.backend).require(Action::record, "--log");
}

SessionConfig sessionConfig(const TouchCommandOptions& options, Log& log) {
  SessionConfig config{.model = options.model.config(),
                       .force = options.force,
                       .undo = options.undo,
                       .hands = {options.hand.config(options.path, options.penetration_mm)},
                       .rate_Hz = options.session.rate_Hz,
                       .duration_s = options.hand.duration_s};
  setBackend(config, options.backend);
  config.realtime = options.session.realtime;
  config.motion = motionConfig(options.motion);
  config.join = joinConfig(options.join, config.model.file, options.stream.live);
  if (config.join) {
    std::string joined = "--join " + config.model.file;  // which excludes the options of a stream
    streamConfig(options.stream, joined);
  } else {
    const RosQuestion ros{options.join.network, log};
    config.stream = streamConfig(options.stream, config.model.file, &ros);
    config.matter = sceneNamed(config.model.file);
  }
  if (!options.secondDevice.empty())
    config.hands.push_back(
        secondHand(options.hand, options.secondDevice).config(options.secondPath, options.penetration_mm));
  if (const auto kind = valueNamed(kBrushKinds, options.edit)) {
    config.brush = options.brush;
    config.brush->kind = *kind;
    config.brush->keepsDensity &= options.join.name.empty();
  }
  return config;
}

std::string remarkOnSmallBrush(double radius_mm, double spacing_mm, std::string_view control,
                               const std::function<std::string(double mm)>& length) {
  constexpr double kUseful = 2;  // spacings: some ten points
  if (radius_mm >= spacing_mm) return {};
  return fmt::format(
      "a tool of {} is smaller than the spacing of the points, {}: it reaches hardly any, and edits next to nothing; "
      "make {} {} or more",
      length(radius_mm), length(spacing_mm), control, length(kUseful * spacing_mm));
}

}  // namespace palpate
