#include "apps/cli/touch.hpp"

#include "apps/cli/parse_list.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/matter_scenes.hpp"

namespace palpate {

namespace {

void addForceOptions(Options& sub, ForceOptions& force) {
  sub.add("--stiffness", force.stiffness_N_per_mm, "N/mm")
      .check(between(0, bounds::kMaxStiffness_N_per_mm))
      .showDefault();
  sub.add("--damping", force.damping_N_s_per_mm, "N s/mm")
      .check(between(0, bounds::kMaxDamping_N_s_per_mm))
      .showDefault();
  sub.add("--max-force", force.maxForce_N, "N; no force is ever larger (nor does it grow or turn faster than 600 N/s)")
      .check(between(0, bounds::kMaxForce_N))
      .showDefault();
  sub.add("--max-surface-power", force.maxSurfacePower_W, "W; what a surface that moves by itself may do to the hand")
      .check(between(1e-6, bounds::kMaxSurfacePower_W))
      .showDefault();
}

void addEditOptions(Options& sub, TouchCommandOptions& options) {
  sub.add(
         "--edit", options.edit,
         "none, or what a round tool does where the HIP stands deeper than --tau: push, presses the surface down; "
         "carve, cuts the tool out; inflate, along the normals, as high as the hand presses; smooth; flatten, onto the "
         "plane of the surface; grab, along with the hand, outwards too; paint, with --paint-color (only push with "
         "cuda); of a soft body all but carve and paint change the shape in which it rests")
      .check(oneOf(namesOf(kBrushKinds, {"none"})))
      .showDefault();
  sub.add("--tau", options.tau_mm, "how deep the HIP may stand behind the proxy before the surface yields, mm")
      .check(between(0, bounds::kLongest_mm))
      .showDefault();
  sub.add("--beta", options.beta, "push: share of the way to the tool's surface that a point goes per tick, 0 to 1")
      .check(between(0, 1))
      .showDefault();
  sub.add(
         "--strength", options.strength,
         "the other brushes: share of their effect per tick, 0 to 1; of carve the way to the tool's surface, of "
         "inflate a thousandth of its radius, of smooth and flatten the way to their surface, of grab the way to where "
         "the hand has taken a point, of paint the colour")
      .check(between(0, 1))
      .showDefault();
  sub.add("--falloff", options.falloff,
          "inflate, smooth, flatten, grab, paint: how the strength falls off, (1 - r^2)^F at r tool radii from the "
          "place over the hand; a whole number, 0 to 16")
      .check(wholeBetween(0, kMaxFalloff))
      .typeName("F")
      .showDefault();
  sub.add("--paint-color", options.paintColor, "R,G,B, 0 to 255").showDefault();
  sub.addFlag(
      "--keep-points", options.keepPoints,
      "no points are put in where the surface is stretched, and none merge where it is crowded; so it is with --join");
  sub.add("--tool-radius", options.brushRadius_mm, "of the round tool, mm")
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      .showDefault();
  sub.add("--undo", options.undo,
          "take the last N strokes back once the path has ended; a stroke is all that is done in one contact, with "
          "gaps of up to 0.3 s")
      .check(wholeBetween(0, bounds::kMaxCount))
      .typeName("N");
  sub.add("--redo", options.redo, "and do M of them again").check(wholeBetween(0, bounds::kMaxCount)).typeName("M");
  sub.add("--undo-memory", options.undoMemory_MiB,
          "for the strokes that can be taken back, MiB; past it the oldest are forgotten")
      .check(between(bounds::kMinMemory_MiB, bounds::kMaxMemory_MiB))
      .showDefault();
}

void addPathOptions(Options& sub, TouchCommandOptions& options) {
  sub.add("--path", options.path,
          "CSV under the header t_s,x,y,z (s, model units; linear in between; # comments), or builtin:press (straight "
          "down, and stays), slide (1 mm deep, 20 mm along), scan (25 taps), orbit (around, without touching); in a "
          "scene "
          "of water or sand builtin:press (a ball dives) and stir (in circles)")
      .showDefault();
  sub.add("--penetration", options.penetration_mm, "how deep builtin:press goes, mm")
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      .showDefault();
  sub.add("--rate", options.rate_Hz, "ticks per second").check(between(1, bounds::kMaxRate_Hz)).showDefault();
  sub.addFlag("--realtime", options.realtime, "against the wall clock (default: virtual time, as fast as it goes)");
  sub.add("--duration", options.hand.duration_s, "of the session, s (default: as long as the path)")
      .check(between(bounds::kShortest_s, bounds::kLongest_s));
}

void addOutputOptions(Options& sub, TouchCommandOptions& options) {
  sub.add("--trace", options.traceFile, "one row per tick; in virtual time its two wall-clock columns are 0")
      .typeName("FILE.csv");
  sub.add("--picture", options.pictureFile, "the model at the end, with HIP, proxy disc and force arrow: .png or .jpg")
      .typeName("IMG.png");
  sub.add("--save", options.saveFile,
          "write the edited points, with all their other properties; faces and other elements are left out, and a file "
          "of that name which has some, or is not palpate's, stays as OUT.ply.bak")
      .typeName("OUT.ply");
  sub.add("--log", options.logFile,
          "record the session: device poses, forces and edits, for palpate replay; what is there survives a "
          "crash, and on a full disk the session goes on")
      .typeName("SESSION");
  sub.add("--trajectory", options.trajectoryFile,
          "time, position (model units) and force (N) of each tick: with commas under names in a .csv, with "
          "blanks and without names in a .txt")
      .typeName("FILE.csv");
  sub.addFlag("--print-tick", options.backend.timePasses, "list the passes of a tick with threads, bytes and GPU us");
}

std::array<std::uint8_t, 3> paintColor(const TouchCommandOptions& options) {
  return parseList<std::uint8_t, 3>(options.paintColor, ',', "--paint-color", "R,G,B from 0 to 255");
}

void addSecondOptions(Options& sub, TouchCommandOptions& options) {
  sub.add("--second-device", options.secondDevice,
          "what moves a second HIP over the same model, in another hand, which only feels: as --device has it, "
          "with the same --map, --passivity and force (vulkan with the method fused, and cpu; a --tool is the "
          "first hand's)")
      .check(deviceValidator());
  sub.add("--second-path", options.secondPath, "of --second-device path and sim; as --path has it").typeName("PATH");
  sub.add("--second-trace", options.secondTraceFile, "one row per tick of the second hand, as in --trace")
      .typeName("FILE.csv");
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
  // In the order in which somebody new needs them.
  const auto heading = [&](const char* text) { command.heading(text); };
  heading("The model");
  addModelOptions(command, options.model, modelsAndStreams(), false);
  heading("Where the hand goes");
  addPathOptions(command, options);
  heading("What is felt");
  addForceOptions(command, options.force);
  addSurfaceOptions(command, options.backend);
  heading("Sculpting");
  addEditOptions(command, options);
  heading("What is written");
  addOutputOptions(command, options);
  heading("The picture of --picture");
  addPictureOptions(command, options.picture);
  heading("A model that moves");
  addMotionOptions(command, options.motion);
  heading("A depth camera");
  addStreamOptions(command, options.stream);
  heading("A session of others");
  addJoinOptions(command, options.join, JoinAs::hand);
  addRosOptions(command, options.join.ros);
  heading("What answers");
  addBackendOptions(command, options.backend);
  heading("A tool of many points");
  addToolOptions(command, options.backend);
  heading("Devices");
  addHandOptions(command, options.hand);
  heading("A second hand");
  addSecondOptions(command, options);
  heading("Options");
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
  if (!can.keepsEdits && !options.logFile.empty())
    throw UsageError("--log: --backend {} tells nobody of its edits; take vulkan or cpu", options.backend.backend);
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
    std::string joined = "--join " + config.model.file;  // whose options are none of a stream
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
