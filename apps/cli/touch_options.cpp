#include "apps/cli/touch.hpp"

#include "apps/cli/parse_list.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/matter_scenes.hpp"

namespace palpate {

namespace {

void addForceOptions(Options& sub, ForceOptions& force) {
  sub.add("--stiffness", force.stiffness_N_per_mm, "stiffness of the contact spring, N/mm")
      .check(between(0, bounds::kMaxStiffness_N_per_mm))
      .showDefault();
  sub.add("--damping", force.damping_N_s_per_mm, "damping of the contact spring, N s/mm")
      .check(between(0, bounds::kMaxDamping_N_s_per_mm))
      .showDefault();
  sub.add("--max-force", force.maxForce_N, "largest force, N; changes of force are limited to 600 N/s in any case")
      .check(between(0, bounds::kMaxForce_N))
      .showDefault();
  sub.add("--max-surface-power", force.maxSurfacePower_W,
          "largest power that a moving surface may put into the hand, W")
      .check(between(1e-6, bounds::kMaxSurfacePower_W))
      .showDefault();
}

void addEditOptions(Options& sub, TouchCommandOptions& options) {
  sub.add("--edit", options.edit,
          "brush: none, push, carve, inflate, smooth, grab, paint (see --paint-color) or flatten; cuda "
          "has push only, a soft body neither carve nor paint")
      .check(oneOf(namesOf(kBrushKinds, {"none"})))
      .showDefault();
  sub.add("--tau", options.tau_mm, "depth of the HIP behind the proxy from which on the surface yields, mm")
      .check(between(0, bounds::kLongest_mm))
      .showDefault();
  sub.add("--beta", options.beta, "push: fraction of the distance to the tool that a point moves per tick")
      .check(between(0, 1))
      .showDefault();
  sub.add("--strength", options.strength, "all brushes but push: fraction of their effect per tick")
      .check(between(0, 1))
      .showDefault();
  sub.add("--falloff", options.falloff,
          "inflate, smooth, flatten, grab, paint: exponent F of the falloff (1 - r^2)^F, where r is 1 "
          "at the rim")
      .check(wholeBetween(0, kMaxFalloff))
      .typeName("F")
      .showDefault();
  sub.add("--paint-color", options.paintColor, "paint: R,G,B, 0 to 255 each").showDefault();
  sub.addFlag("--keep-points", options.keepPoints,
              "do not insert points where the surface is stretched, nor merge them where it is crowded "
              "(always so with --join)");
  sub.add("--tool-radius", options.brushRadius_mm, "radius of the brush, mm")
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      .showDefault();
  sub.add("--undo", options.undo,
          "undo the last N strokes after the path; a stroke is one contact, gaps up to 0.3 s included")
      .check(wholeBetween(0, bounds::kMaxCount))
      .typeName("N");
  sub.add("--redo", options.redo, "then redo M of them").check(wholeBetween(0, bounds::kMaxCount)).typeName("M");
  sub.add("--undo-memory", options.undoMemory_MiB,
          "memory for strokes that can be undone, MiB; the oldest are dropped first")
      .check(between(bounds::kMinMemory_MiB, bounds::kMaxMemory_MiB))
      .showDefault();
}

void addPathOptions(Options& sub, TouchCommandOptions& options) {
  sub.add("--path", options.path,
          "CSV with the header t_s,x,y,z (s, model units), or builtin:press, builtin:slide, "
          "builtin:scan, builtin:orbit; in water or sand builtin:press and builtin:stir")
      .showDefault();
  sub.add("--penetration", options.penetration_mm, "depth of builtin:press, mm")
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      .showDefault();
  sub.add("--rate", options.rate_Hz, "ticks per second").check(between(1, bounds::kMaxRate_Hz)).showDefault();
  sub.addFlag("--realtime", options.realtime,
              "run against the wall clock (default: virtual time, as fast as possible)");
  sub.add("--duration", options.hand.duration_s, "duration of the session, s (default: that of the path)")
      .check(between(bounds::kShortest_s, bounds::kLongest_s));
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
  sub.addFlag("--print-tick", options.backend.timePasses,
              "list the GPU passes of a tick with threads, bytes and GPU time, us");
}

std::array<std::uint8_t, 3> paintColor(const TouchCommandOptions& options) {
  return parseList<std::uint8_t, 3>(options.paintColor, ',', "--paint-color", "R,G,B from 0 to 255");
}

void addSecondOptions(Options& sub, TouchCommandOptions& options) {
  sub.add("--second-device", options.secondDevice,
          "device of a second hand, which feels the same model and does not sculpt (vulkan with the "
          "method fused, or cpu); values as for --device")
      .check(deviceValidator());
  sub.add("--second-path", options.secondPath,
          "path of the second hand, for --second-device path and sim; values as for --path")
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
  checkHandOptions(secondHand(options.hand, device), options.realtime);
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
  addForceOptions(command, options.force);
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
  checkHandOptions(options.hand, options.realtime);
  checkSecondOptions(options);
  if (options.edit == "none") {
    if (!options.saveFile.empty() && options.stream.fuse != "on" && options.join.name.empty() &&
        !matterScene(options.model.file))
      throw UsageError("--save: nothing changes with --edit none");
    if (options.undo > 0) throw UsageError("--undo: nothing changes with --edit none");
  }
  if (options.redo > 0 && options.undo == 0) throw UsageError("--redo: only what --undo took back can be done again");
  if (options.picture.printFrame && options.pictureFile.empty()) throw UsageError("--print-frame: needs --picture");
  if (!options.logFile.empty())
    Abilities(ModelKind::cloud, can, options.backend.backend).require(Action::record, "--log");
}

SessionConfig sessionConfig(const TouchCommandOptions& options, Log& log) {
  SessionConfig config{.model = options.model.config(),
                       .force = options.force,
                       .undo = {.undo = options.undo, .redo = options.redo, .memory_MiB = options.undoMemory_MiB},
                       .hands = {options.hand.config(options.path, options.penetration_mm)},
                       .rate_Hz = options.rate_Hz,
                       .duration_s = options.hand.duration_s};
  setBackend(config, options.backend);
  config.realtime = options.realtime;
  config.motion = motionConfig(options.motion);
  config.join = joinConfig(options.join, config.model.file, options.stream.live);
  if (config.join) {
    std::string joined = "--join " + config.model.file;  // which excludes the options of a stream
    streamConfig(options.stream, joined);
  } else {
    const RosQuestion ros{options.join.network, log};
    config.stream = streamConfig(options.stream, config.model.file, &ros);
    config.matter = matterScene(config.model.file);
  }
  if (!options.secondDevice.empty())
    config.hands.push_back(
        secondHand(options.hand, options.secondDevice).config(options.secondPath, options.penetration_mm));
  if (const auto kind = valueNamed(kBrushKinds, options.edit))
    config.brush = BrushConfig{.kind = *kind,
                               .tau_mm = options.tau_mm,
                               .beta = options.beta,
                               .radius_mm = options.brushRadius_mm,
                               .strength = options.strength,
                               .falloff = options.falloff,
                               .color = paintColor(options),
                               .keepsDensity = !options.keepPoints && options.join.name.empty()};
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
