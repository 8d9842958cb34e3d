#include "apps/touch.hpp"

#include "apps/parse_list.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

void addForceOptions(CLI::App& sub, ForceOptions& force) {
  sub.add_option("--stiffness", force.stiffness_N_per_mm, "N/mm")
      ->check(between(0, bounds::kMostStiffness_N_per_mm))
      ->capture_default_str();
  sub.add_option("--damping", force.damping_N_s_per_mm, "N s/mm")
      ->check(between(0, bounds::kMostDamping_N_s_per_mm))
      ->capture_default_str();
  sub.add_option("--max-force", force.maxForce_N,
                 "N; no force is ever larger (nor does it grow or turn faster than 600 N/s)")
      ->check(between(0, bounds::kMostForce_N))
      ->capture_default_str();
}

void addEditOptions(CLI::App& sub, TouchCommandOptions& options) {
  std::vector<std::string> edits{"none"};
  for (const auto& [name, kind] : kBrushKinds) edits.emplace_back(name);
  sub.add_option("--edit", options.edit,
                 "none, or what a round tool does where the HIP stands deeper than --tau: push, the surface yields to "
                 "it; carve, cuts it out; inflate, along the normals; smooth; grab, along with the hand; paint, with "
                 "--paint-color (only push with cuda)")
      ->check(CLI::IsMember(std::move(edits)))
      ->capture_default_str();
  sub.add_option("--tau", options.tau_mm, "how deep the HIP may stand behind the proxy before the surface yields, mm")
      ->check(between(0, bounds::kLongest_mm))
      ->capture_default_str();
  sub.add_option("--beta", options.beta,
                 "push: share of the way to the tool's surface that a point goes per tick, 0 to 1")
      ->check(between(0, 1))
      ->capture_default_str();
  sub.add_option(
         "--strength", options.strength,
         "the other brushes: share of their effect per tick, 0 to 1; of carve the way to the tool's surface, of "
         "inflate a thousandth of its radius, of smooth the way to a smooth surface, of grab the hand's motion, "
         "of paint the colour")
      ->check(between(0, 1))
      ->capture_default_str();
  sub.add_option(
         "--falloff", options.falloff,
         "inflate, smooth, grab, paint: how the strength falls off, (1 - r^2)^F at r tool radii from the proxy; "
         "a whole number, 0 to 16")
      ->check(wholeBetween(0, kMostFalloff))
      ->type_name("F")
      ->capture_default_str();
  sub.add_option("--paint-color", options.paintColor, "R,G,B, 0 to 255")->capture_default_str();
  sub.add_flag("--keep-points", options.keepPoints,
               "no points are put in where the surface is stretched, and none merge where it is crowded");
  sub.add_option("--tool-radius", options.toolRadius_mm, "of the round tool, mm")
      ->check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      ->capture_default_str();
  sub.add_option("--undo", options.undo,
                 "take the last N strokes back once the path has ended; a stroke is all that is done in one contact")
      ->check(wholeBetween(0, bounds::kMostCount))
      ->type_name("N");
  sub.add_option("--redo", options.redo, "and do M of them again")
      ->check(wholeBetween(0, bounds::kMostCount))
      ->type_name("M");
  sub.add_option("--undo-memory", options.undoMemory_MiB,
                 "for the strokes that can be taken back, MiB; past it the oldest are forgotten")
      ->check(between(bounds::kLeastMemory_MiB, bounds::kMostMemory_MiB))
      ->capture_default_str();
}

void addPathOptions(CLI::App& sub, TouchCommandOptions& options) {
  sub.add_option(
         "--path", options.path,
         "CSV under the header t_s,x,y,z (s, model units; linear in between; # comments), or builtin:press (straight "
         "down, and stays), slide (1 mm deep, 20 mm along), scan (25 taps), orbit (around, without touching)")
      ->capture_default_str();
  sub.add_option("--penetration", options.penetration_mm, "how deep builtin:press goes, mm")
      ->check(between(bounds::kShortest_mm, bounds::kLongest_mm))
      ->capture_default_str();
  sub.add_option("--rate", options.rate_Hz, "ticks per second")
      ->check(between(1, bounds::kMostRate_Hz))
      ->capture_default_str();
  sub.add_flag("--realtime", options.realtime, "against the wall clock (default: virtual time, as fast as it goes)");
  sub.add_option("--duration", options.stylus.duration_s, "of the session, s (default: as long as the path)")
      ->check(between(bounds::kShortest_s, bounds::kLongest_s));
}

void addOutputOptions(CLI::App& sub, TouchCommandOptions& options) {
  sub.add_option("--trace", options.traceFile, "one row per tick; in virtual time its two wall-clock columns are 0")
      ->type_name("FILE.csv");
  sub.add_option("--picture", options.pictureFile,
                 "the model at the end, with HIP, proxy disc and force arrow: .png or .jpg")
      ->type_name("IMG.png");
  sub.add_option(
         "--save", options.saveFile,
         "write the edited points, with all their other properties; faces and other elements are left out, and a file "
         "of that name which has some, or is not palpate's, stays as OUT.ply.bak")
      ->type_name("OUT.ply");
  sub.add_option("--log", options.logFile,
                 "record the session: device poses, forces and edits, for palpate replay; what is there survives a "
                 "crash, and on a full disk the session goes on")
      ->type_name("SESSION");
  sub.add_option("--trajectory", options.trajectoryFile,
                 "time, position (model units) and force (N) of each tick: with commas under names in a .csv, with "
                 "blanks and without names in any other file")
      ->type_name("FILE");
  sub.add_flag("--print-tick", options.backend.timePasses, "list the passes of a tick with threads, bytes and GPU us");
}

std::array<std::uint8_t, 4> paintColor(const TouchCommandOptions& options) {
  const auto rgb = parseList<std::uint8_t, 3>(options.paintColor, ',', "--paint-color", "R,G,B from 0 to 255");
  return {rgb[0], rgb[1], rgb[2], 255};
}

void addSecondOptions(CLI::App& sub, TouchCommandOptions& options) {
  sub.add_option("--second-device", options.secondDevice,
                 "what moves a second HIP over the same model, in another hand, which only feels: as --device has it, "
                 "with the same --map, --passivity and force (vulkan with the method fused, and cpu; a --tool is the "
                 "first hand's)")
      ->check(deviceValidator());
  sub.add_option("--second-path", options.secondPath, "of --second-device path and sim; as --path has it")
      ->type_name("PATH");
  sub.add_option("--second-trace", options.secondTraceFile, "one row per tick of the second hand, as in --trace")
      ->type_name("FILE.csv");
}

void checkSecondOptions(const TouchCommandOptions& options) {
  const std::string& device = options.secondDevice;
  if (device.empty()) {
    if (!options.secondPath.empty()) throw UsageError("--second-path: there is no second hand; add --second-device");
    if (!options.secondTraceFile.empty())
      throw UsageError("--second-trace: there is no second hand; add --second-device");
    return;
  }
  checkStylusOptions(secondStylus(options.stylus, device), options.realtime);
  if (isHeldDevice(device) && device == options.stylus.device)
    throw UsageError("--second-device: {} is in the first hand; name another one, as in openhaptics:NAME", device);
  const bool followsPath = device == "path" || device == "sim";
  if (followsPath && options.secondPath.empty())
    throw UsageError("--second-device {}: say where it goes with --second-path", device);
  if (!followsPath && !options.secondPath.empty())
    throw UsageError("--second-path: {} follows none; it is for path and sim", device);
  if (!options.logFile.empty())
    throw UsageError(
        "--log: a session log has one hand; leave it or --second-device out (--second-trace keeps a trace)");
  if (options.backend.backend == "cuda")
    throw UsageError("--second-device: --backend cuda feels with one hand; take vulkan or cpu");
  if (options.backend.backend == "vulkan" && methodName(options.backend) != "fused")
    throw UsageError("--second-device: --method {} feels with one hand; take fused", options.backend.method);
  if (options.backend.ahead == "on") throw UsageError("--ahead: two hands are not asked ahead; leave it out");
}

}  // namespace

void addTouchOptions(CLI::App& command, TouchCommandOptions& options) {
  // In the order in which somebody new needs them.
  const auto heading = [&](const char* text) { command.option_defaults()->group(text); };
  heading("The model");
  addModelOptions(command, options.model);
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
  heading("What answers");
  addBackendOptions(command, options.backend);
  heading("A tool of many points");
  addToolOptions(command, options.backend);
  heading("Devices");
  addStylusOptions(command, options.stylus);
  heading("A second hand");
  addSecondOptions(command, options);
  heading("Options");
}

void checkTouchOptions(const TouchCommandOptions& options) {
  checkBackendOptions(options.backend);
  paintColor(options);
  if (options.edit != "none" && options.edit != "push" && options.backend.backend == "cuda")
    throw UsageError("--edit: --backend cuda has only push; take vulkan or cpu for {}", options.edit);
  checkPictureOptions(options.picture);
  imageFormatOf(options.pictureFile);
  checkStylusOptions(options.stylus, options.realtime);
  checkSecondOptions(options);
  if (options.edit == "none") {
    if (!options.saveFile.empty()) throw UsageError("--save: nothing changes with --edit none");
    if (options.undo > 0) throw UsageError("--undo: nothing changes with --edit none");
  }
  if (options.redo > 0 && options.undo == 0) throw UsageError("--redo: only what --undo took back can be done again");
  if (options.picture.printFrame && options.pictureFile.empty()) throw UsageError("--print-frame: needs --picture");
  if (options.backend.backend == "cuda" && options.undo > 0)
    throw UsageError("--undo: --backend cuda tells nobody of its edits; take vulkan or cpu");
  if (options.backend.backend == "cuda" && !options.logFile.empty())
    throw UsageError("--log: --backend cuda tells nobody of its edits; take vulkan or cpu");
}

std::optional<BrushOptions> brushOptions(const TouchCommandOptions& options, const ModelScale& scale) {
  for (const auto& [name, kind] : kBrushKinds)
    if (options.edit == name)
      return BrushOptions{.kind = kind,
                          .tau = scale.toUnits(options.tau_mm),
                          .beta = options.beta,
                          .toolRadius = scale.toUnits(options.toolRadius_mm),
                          .strength = options.strength,
                          .falloff = options.falloff,
                          .color = paintColor(options),
                          .keepsDensity = !options.keepPoints};
  return std::nullopt;
}

std::string tooSmallTool(double radius_mm, double spacing_mm, std::string_view control) {
  constexpr double kUseful = 2;  // spacings: some ten points
  if (radius_mm >= spacing_mm) return {};
  return fmt::format(
      "a tool of {:.3g} mm is smaller than the spacing of the points, {:.3g} mm: it reaches hardly any, and edits next "
      "to nothing; make {} {:.2g} mm or more",
      radius_mm, spacing_mm, control, kUseful * spacing_mm);
}

std::uint64_t undoBytes(const TouchCommandOptions& options) {
  constexpr double kMiB = 1 << 20, kMost = 1e18;
  return options.undo > 0 ? static_cast<std::uint64_t>(std::min(kMost, options.undoMemory_MiB * kMiB)) : 0;
}

}  // namespace palpate
