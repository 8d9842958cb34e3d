#include "apps/cli/touch.hpp"

#include "apps/cli/setting_options.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "haptics/builtin_path.hpp"
#include "haptics/session/abilities.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

void addEditOptions(Options& sub, TouchCommandOptions& options) {
  addSettingFor<BrushConfig>(sub, options.edit, "kind")
      .check(oneOf(choicesOf<BrushConfig>("kind", {"none"})))
      .showDefault();
  addSettings(sub, options.brush, "kind");
  addMaskOptions(sub, options.masks);
  options.layer = sub.add("--layer-strength", options.layerStrength,
                          "strength of the strokes at the end, as of a layer in the window: with 0 the points are as "
                          "before them, with 1 as they were made; deep cuts or pulls have a smaller range")
                      .typeName("S")
                      .check(between(kMinLayerStrength, kMaxLayerStrength));
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
      .typeName("FILE.csv")
      .writes(Writes::replacing);
  sub.add("--picture", options.pictureFile,
          "picture of the model at the end with HIP, proxy disc and force arrow, .png or .jpg")
      .typeName("IMG.png")
      .writes(Writes::replacing);
  sub.add("--save", options.saveFile,
          "write the edited points with all their properties; faces and other elements are dropped. PLY keeps the "
          "Gaussians of a splat scene. An existing file is kept as OUT.ply.bak")
      .typeName("OUT.ply")
      .writes(Writes::keeping);
  sub.add("--log", options.logFile,
          "record poses, forces and edits for palpate replay; what is recorded survives a crash")
      .typeName("SESSION")
      .writes(Writes::replacing);
  sub.add("--trajectory", options.trajectoryFile,
          "time, position (model units) and force (N) of each tick: comma-separated with a header in a "
          ".csv, else blank-separated without one")
      .typeName("FILE")
      .writes(Writes::replacing);
  addSettingFor<BackendConfig>(sub, options.backend.timePasses, "times_passes");
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
  options.stiffness = addSetting(command, options.force, "stiffness_N_per_mm")
                          .describe(fmt::format("{} (default: as remembered for a device, else {})",
                                                settingNamed<ForceOptions>("stiffness_N_per_mm").help,
                                                ForceOptions{}.stiffness_N_per_mm));
  addSettings(command, options.force, "stiffness_N_per_mm");
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
  addFurtherHandOption(command, options.hands);
  heading("Options");
  command.helpShows(
      {"--mm-per-unit", "--normals",   "--path",        "--penetration",  "--rate",     "--realtime",  "--duration",
       "--stiffness",   "--damping",   "--max-force",   "--surface",      "--friction", "--radius",    "--edit",
       "--yield-depth", "--strength",  "--paint-color", "--brush-radius", "--lock",     "--undo",      "--trace",
       "--picture",     "--save",      "--log",         "--up",           "--size",     "--camera",    "--color",
       "--motion",      "--live",      "--fuse",        "--join",         "--partial",  "--interface", "--backend",
       "--tool",        "--tool-size", "--device",      "--map",          "--hand"});
}

void checkTouchOptions(const TouchCommandOptions& options, const TouchCapabilities& can) {
  checkPictureOptions(options.picture, options.pictureFile);
  checkHandOptions(options.hand, options.session.realtime);
  if (!furtherHands(options.hands, options.hand, options.session.realtime).empty() && !options.logFile.empty())
    throw UsageError("--log: a session log has one hand; leave out --log or --hand (its trace= keeps a trace)");
  if (options.edit == "none") {
    if (!options.saveFile.empty() && options.stream.fuse != "on" && options.join.name.empty() &&
        !sceneNamed(options.model.file))
      throw UsageError("--save: requires a brush (--edit); without one no point changes");
    if (options.undo.undo > 0) throw UsageError("--undo: requires a brush (--edit); without one no point changes");
    if (options.layer->given())
      throw UsageError("--layer-strength: requires a brush (--edit); without one no point changes");
  }
  checkMaskOptions(options.masks, options.edit != "none");
  if (options.undo.redo > 0 && options.undo.undo == 0)
    throw UsageError("--redo: requires --undo; only undone strokes can be redone");
  if (options.picture.printFrame && options.pictureFile.empty()) throw UsageError("--print-frame: needs --picture");
  if (!options.logFile.empty())
    Abilities(ModelKind::cloud, can, options.backend.backend).require(Action::record, "--log");
}

SessionConfig sessionConfig(const TouchCommandOptions& options, Log& log) {
  SessionConfig config{.model = chosenModel(options.model, options.stream, options.join, log),
                       .force = options.force,
                       .undo = options.undo,
                       .hands = {options.hand.config(options.path, options.penetration_mm)},
                       .rate_Hz = options.session.rate_Hz,
                       .duration_s = options.hand.duration_s};
  setBackend(config, options.backend);
  config.realtime = options.session.realtime;
  config.motion = motionConfig(options.motion);
  for (const FurtherHand& hand : furtherHands(options.hands, options.hand, options.session.realtime))
    config.hands.push_back(choicesFor(options.hand, hand).config(hand.path, options.penetration_mm));
  if (const auto kind = valueNamed(kBrushKinds, options.edit)) {
    config.brush = options.brush;
    config.brush->kind = *kind;
    config.brush->resample &= options.join.name.empty();
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
