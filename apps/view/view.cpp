// `palpate view`: the window.
#include "apps/cli/backend.hpp"
#include "apps/cli/motion_options.hpp"
#include "apps/cli/parse_list.hpp"
#include "apps/cli/picture.hpp"
#include "apps/cli/setting_options.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "apps/cli/stream_options.hpp"
#include "apps/cli/system_places.hpp"
#include "apps/view/kept_settings.hpp"
#include "apps/view/theme.hpp"
#include "apps/view/viewer.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/thread_priority.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

struct ViewCommandOptions {
  std::vector<std::string> models;
  LookOptions look;
  ColorConfig color;
  LightConfig light;
  std::string guides;
  MotionOptions motion;
  StreamOptions stream;
  JoinOptionsGiven join;
  ScaleOptions scale;
  std::string normals = "keep", size, script, sightGpu, backend = "auto", surface = "average", edit = "none",
              resolution = "128", device = "auto", axes, scheduler = "device", present = "auto", symmetry, theme,
              textSize;
  bool hidesCamera = false, rumble = false, realtime = false, keepUnreliable = false;
  PrepareOptions prepare;
  double rate_Hz = 1000, undoMemory_MiB = 1024;
};

/// The device that is asked for is opened before the window, as the user may be asked to calibrate it; the one that was
/// used last, while the window is there. A script has no device but the one that it asks for.
void hold(const ViewCommandOptions& options, HeldDevice& held) {
  if (options.device != "auto" && options.device != HeldDevice::kMouse) return held.open(options.device);
  if (options.device == HeldDevice::kMouse) return held.choose(HeldDevice::kMouse);
  if (options.script.empty()) held.chooseLast();
}

/// Sets the model if the first one is a joined session or a live camera; files can be opened after it. Recordings, also
/// later ones, are played with the same options.
void setModel(const StreamOptions& stream, const JoinOptionsGiven& join, Log& log, ViewOptions& view) {
  SessionConfig& config = view.session.config;
  std::string first = view.models.empty() ? std::string() : view.models.front();
  config.model.join = joinConfig(join, first, stream.live);
  view.session.network = join.network;
  view.session.hand = join.hand;
  if (config.model.join) {
    if (config.motion) Abilities(modelKindOf(config)).require(Action::move, "--motion");
  } else if (!first.empty() || !stream.live.empty()) {
    const RosQuestion ros{join.network, log};
    const std::optional<StreamConfig> played = streamConfig(stream, first, &ros);
    (played && played->live ? config.model.stream.emplace() : view.session.stream) = played.value_or(StreamConfig{});
  }
  if (!config.model.join && !config.model.stream) return;
  view.models = {first};
  config.model.file = first;
}

// Without a display, an error in the model file is reported first.
std::unique_ptr<Window> openWindow(const ViewOptions& view) {
  try {
    return std::make_unique<Window>(view.size_px, "palpate", true, view.place);
  } catch (const Error&) {
    const std::string file = view.models.empty() ? std::string() : view.models.front();
    const bool isFile = !file.empty() && view.session.config.model.file.empty() && !isRosModel(file) &&
                        !isRgbdFolder(file) && !sceneNamed(file);
    if (isFile) contentsOf(file);
    throw;
  }
}

void view(Context& context, const ViewCommandOptions& options) {
  validate(options.color);
  const GuideConfig guides = guidesNamed(options.guides, "--guides");
  // A held device requires realtime, also while a script plays.
  const bool isHeld = options.device != "auto" && options.device != HeldDevice::kMouse;
  const bool realtime = options.script.empty() || options.realtime || isHeld;
  HeldDevice held({.rate_Hz = options.rate_Hz,
                   .ownScheduler = options.scheduler == "own",
                   .rumbles = options.rumble,
                   .realtime = realtime,
                   .quiet = context.log().isQuiet(),
                   .axes = options.axes});
  ViewOptions view{.models = options.models,
                   .look = options.look,
                   .color = options.color,
                   .light = options.light,
                   .guides = guides,
                   .resolution = std::stoi(options.resolution),
                   .held = held};
  if (!options.size.empty()) {
    const auto [width, height] = parseList<std::uint32_t, 2>(options.size, 'x', "--size", "WIDTHxHEIGHT in pixels");
    Frame::checkSize(width, height);
    view.size_px = {width, height};
  } else if (const auto kept = KeptSettings::read(); kept && options.script.empty()) {
    view.place = kept->place;
  }
  if (!options.script.empty()) view.script = readScript(options.script);
  view.session.config.model = ModelOptions{.scale = options.scale,
                                           .normals = options.normals,
                                           .keepUnreliable = options.keepUnreliable,
                                           .prepare = options.prepare}
                                  .config();
  view.session.exceedsMemory = context.isForced();
  view.session.config.rate_Hz = options.rate_Hz;
  view.session.config.motion = motionConfig(options.motion);
  if (options.edit != "none") Abilities(modelKindOf(view.session.config)).require(Action::sculpt, "--edit");
  setModel(options.stream, options.join, context.log(), view);
  if (options.hidesCamera && !view.session.config.model.join)
    throw UsageError("--hide-camera: requires --join; a model that is not shared has no other participants");
  view.session.hidesCamera = options.hidesCamera;
  view.session.ros = options.join.ros.name;
  constexpr double kMiB = 1 << 20;
  view.session.undo.bytes = static_cast<std::uint64_t>(options.undoMemory_MiB * kMiB);
  for (const auto& [name, kind] : kSurfaceKinds)
    if (options.surface == name) view.feel.surface = kind;
  if (const auto kind = valueNamed(kBrushKinds, options.edit)) {
    view.brush.kind = *kind;
    view.brush.sculpts = true;
  }
  if (!options.symmetry.empty()) symmetryPlane(options.symmetry, DVec3(0));  // throws for a wrong one
  view.brush.symmetry = options.symmetry;

  hold(options, held);
  if (!realtime) view.session.live.clock = std::make_shared<SteppedClock>();

  if (const std::filesystem::path state = stateFolder(); !state.empty()) {
    constexpr std::uint64_t kDisk = 8;  // in place of each byte of memory
    view.session.live.unsavedIn = state / "palpate" / "unsaved";
    view.session.undo.folder = state / "palpate";
    view.session.undo.disk_bytes = kDisk * view.session.undo.bytes;
  }

  if (!options.theme.empty()) view.dark = valueNamed(kThemes, options.theme);
  if (!options.textSize.empty()) view.text_percent = valueNamed(kTextSizes, options.textSize);
  const std::unique_ptr<Window> shown = openWindow(view);
  Window& window = *shown;
  for (const auto& [name, presentation] : kPresentations)
    if (options.present == name) view.presentation = presentation;
  // With copied pictures no surface extensions are requested: the driver may crash in surface queries.
  const bool copies = view.presentation == Presentation::copy;
  context.showInWindows(copies ? std::vector<std::string>() : window.extensions());
  const RunningThreads ours;
  Device& touch = context.device();
  const ChosenBackend chosen = chooseBackend(context, {.backend = options.backend});
  view.session.config.backend.name = chosen.name;
  view.session.backendIsOpen = chosen.isOpen && realtime;
  if (touch.isCpu()) ours.laterOnesGiveWay();  // threads of the software driver
  Device& sight = options.sightGpu.empty() ? touch : context.sightDevice(options.sightGpu);
  const StopBySignal stop;
  Viewer(context, window, sight, view).run();
}

// The window itself, and the script that plays in it.
void addWindowOptions(Options& sub, ViewCommandOptions& options) {
  sub.add("--size", options.size,
          "size of the window, WIDTHxHEIGHT, pixels; default: as the window was last, else 1280x720");
  sub.add("--theme", options.theme, "dark or light panels and background; default: as the window was last")
      .check(oneOf({"dark", "light"}));
  sub.add("--text-size", options.textSize, "size of the panels and their text, %; default: as the window was last")
      .check(oneOf(namesOf(kTextSizes)));
  sub.add("--script", options.script,
          fmt::format("play timed events, one per line: TIME_S EVENT; # comments. Events: {}", scriptEventNames()))
      .typeName("FILE");
  sub.addFlag("--realtime", options.realtime,
              "run the script against the wall clock; otherwise each picture is 0.05 s of script time with "
              "all its ticks, on any machine");
  sub.add("--sight-gpu", options.sightGpu, "draw on another GPU: number or part of its name").typeName("N|NAME");
  sub.add("--present", options.present,
          "presentation: swapchain, copy (through the host to an X display that the GPU cannot present "
          "to, e.g. a remote desktop), or auto; palpate doctor tells which one")
      .check(oneOf({"auto", "swapchain", "copy"}))
      .showDefault();
}

}  // namespace

void addView(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand(
      "view", "open the window: feel, see and sculpt with a mouse, a gamepad, a 3D mouse or a haptic device");
  auto options = std::make_shared<ViewCommandOptions>();
  sub.add("models", options->models,
          modelsAndStreams() + ". The first one is opened, others can be dropped on the window")
      .typeName("MODEL")
      .offers(builtInSceneNames());
  addScaleOptions(sub, options->scale);
  addSettingFor<ModelConfig>(sub, options->normals, "normals")
      .describe("keep, estimate, face, orient or flip, as in palpate touch")
      .check(oneOf(choicesOf<ModelConfig>("normals")))
      .showDefault();
  addAllPointsOption(sub, options->keepUnreliable);
  addPrepareOptions(sub, options->prepare);
  addLookOptions(sub, options->look);
  addSettings(sub, options->color, {});
  addSettings(sub, options->light, {});
  addGuidesOption(sub, options->guides);
  addWindowOptions(sub, *options);
  sub.add("--device", options->device,
          "device that moves the stylus: mouse (or keys and a gamepad); auto: the one that the window used last, and "
          "the "
          "mouse if there was none or it is not there; " +
              heldDevicesHelp())
      .check(Check{[](const std::string& device) {
                     return device == "auto" || device == HeldDevice::kMouse || isHeldDevice(device)
                                ? std::string()
                                : "'" + device + "' is not a device; devices are auto, mouse, " + heldDevicesHelp();
                   },
                   "DEVICE"})
      .offers(heldDeviceNames({"auto", HeldDevice::kMouse}))
      .showDefault();
  addSettingFor<HandConfig>(sub, options->axes, "axes").check(Check{axesComplaint, "RIGHT,UP,TOWARDS"});
  sub.add("--scheduler", options->scheduler, "thread that runs the ticks of an OpenHaptics device, as in palpate touch")
      .check(oneOf({"device", "own"}))
      .showDefault();
  sub.addFlag("--rumble", options->rumble, "a DualSense on a cable rumbles at each contact");
  sub.add("--backend", options->backend, "back end: vulkan, cpu, or auto (cpu where the GPU is a software driver)")
      .check(oneOf({"auto", "vulkan", "cpu"}))
      .showDefault();
  addSettingFor<SurfaceConfig>(sub, options->surface, "kind")
      .describe("average, sphere or sharp, as in palpate touch")
      .check(oneOf(choicesOf<SurfaceConfig>("kind")))
      .showDefault();
  addSettingFor<BrushConfig>(sub, options->edit, "kind")
      .describe("brush at the start, or none")
      .check(oneOf(choicesOf<BrushConfig>("kind", {"none"})))
      .showDefault();
  addSettingFor<BrushConfig>(sub, options->symmetry, "symmetry");
  sub.add("--resolution", options->resolution,
          "cells of the mesh (M) along the longest side; coarse meshes update sooner on a slow GPU")
      .check(oneOf({"32", "64", "128", "256", "512"}))
      .showDefault();
  addSettingFor<SessionConfig>(sub, options->rate_Hz, "rate_Hz").showDefault();
  addSettingFor<UndoConfig>(sub, options->undoMemory_MiB, "memory_MiB")
      .describe("memory for strokes that can be undone, MiB; the oldest go to the disk, up to eight times as much")
      .showDefault();
  sub.heading("Shared session");
  addJoinOptions(sub, options->join, JoinAs::hand);
  sub.addFlag("--hide-camera", options->hidesCamera, "do not show the camera of this window to the other participants");
  sub.add("--ros", options->join.ros.name,
          "publish the camera for ROS 2 as NAME/camera; network as for --interface, --peer, --domain "
          "and --security")
      .typeName("NAME");
  sub.heading("Motion");
  addMotionOptions(sub, options->motion);
  sub.heading("Depth camera");
  addStreamOptions(sub, options->stream);
  sub.heading("Options");
  sub.helpShows({"--mm-per-unit", "--up",          "--unit",    "--color-by",   "--material", "--size",
                 "--script",      "--realtime",    "--device",  "--backend",    "--surface",  "--edit",
                 "--rate",        "--undo-memory", "--present", "--join",       "--partial",  "--interface",
                 "--motion",      "--live",        "--fuse",    "--intrinsics", "--speed"});
  sub.footer(
      "Hold Space and move the mouse over the model: it is the stylus now. Press the left button to "
      "touch, and to sculpt once a brush is chosen (keys 2 to 8). H shows all keys.\n");
  sub.whenNamed([&, options] { command = [&context, options] { view(context, *options); }; });
}

}  // namespace palpate
