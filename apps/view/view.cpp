// `palpate view`: the window.
#include "apps/devices.hpp"
#include "apps/parse_list.hpp"
#include "apps/view/viewer.hpp"
#include "engine/core/thread_priority.hpp"

namespace palpate {

namespace {

struct ViewCommandOptions {
  std::vector<std::string> models;
  LookOptions look;
  double mm_per_unit = 0;
  std::string normals = "keep", size = "1280x720", script, sightGpu, backend = "auto", surface = "average",
              edit = "none", device = "mouse", scheduler = "device", present = "auto";
  bool rumble = false, realtime = false;
  double rate_Hz = 1000, undoMemory_MiB = 1024;
};

/// Opens the device that a person holds. The window is not there yet: the person may be asked to calibrate it.
void hold(Context& context, const ViewCommandOptions& options, SessionOptions& session) {
  const Scheduler scheduler = options.scheduler == "own" ? Scheduler::own : Scheduler::device;
  OpenedDevice opened = openDevice(options.device, scheduler, options.rate_Hz, context.log(), nullptr);
  if (options.rumble) opened.device = withRumble(std::move(opened.device), context.log());
  // Turned about the middle of the workspace, it has its origin there.
  const DVec3 middle_mm = 0.5 * (opened.facts.workspaceMin_mm + opened.facts.workspaceMax_mm);
  opened.facts.workspaceMin_mm -= middle_mm;
  opened.facts.workspaceMax_mm -= middle_mm;
  session.device = std::make_shared<TurnedDevice>(std::move(opened.device), middle_mm);
  session.deviceFacts = opened.facts;
}

void view(Context& context, const ViewCommandOptions& options) {
  const auto [width, height] = parseList<std::uint32_t, 2>(options.size, 'x', "--size", "WIDTHxHEIGHT in pixels");
  Frame::checkSize(width, height);
  ViewOptions view{.models = options.models, .look = options.look, .size_px = {width, height}};
  if (!options.script.empty()) view.script = readScript(options.script);
  view.session.model.mm_per_unit = options.mm_per_unit;
  view.session.model.normals = options.normals;
  view.session.rate_Hz = options.rate_Hz;
  constexpr double kMiB = 1 << 20;
  view.session.undo_bytes = static_cast<std::uint64_t>(options.undoMemory_MiB * kMiB);
  for (const auto& [name, kind] : kSurfaceKinds)
    if (options.surface == name) view.feel.surface = kind;
  for (const auto& [name, kind] : kBrushKinds)
    if (options.edit == name) view.tool.brush = kind;

  if (options.device != "mouse") hold(context, options, view.session);
  // A person who holds a device lives in real time, also while a script plays.
  const bool realtime = options.script.empty() || options.realtime || options.device != "mouse";
  if (!realtime) view.session.clock = std::make_shared<SteppedClock>();

  Window window(view.size_px, "palpate");
  for (const auto& [name, presentation] : kPresentations)
    if (options.present == name) view.presentation = presentation;
  // Where pictures are copied nothing is asked of the window system that its driver may not survive.
  const bool copies = view.presentation == Presentation::copy;
  context.showInWindows(copies ? std::vector<std::string>() : window.extensions());
  const RunningThreads ours;
  Device& touch = context.device();
  view.session.backend.backend = chooseBackend(context, {.backend = options.backend});
  if (touch.isCpu()) ours.laterOnesGiveWay();  // the driver's
  Device& sight = options.sightGpu.empty() ? touch : context.sightDevice(options.sightGpu);
  Viewer(context, window, sight, std::move(view)).run();
}

}  // namespace

void addView(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand(
      "view", "the window: feel, see and sculpt at the same time, with a mouse, a gamepad or a 3D mouse");
  auto options = std::make_shared<ViewCommandOptions>();
  sub->add_option("models", options->models, "PLY files; the first one is opened, others can be dropped on the window")
      ->type_name("MODEL...");
  sub->add_option("--mm-per-unit", options->mm_per_unit,
                  "millimetres per model unit (default: the longest side becomes 100 mm)")
      ->check(between(bounds::kLeastScale, bounds::kMostScale));
  sub->add_option("--normals", options->normals, "keep, estimate or face, as in palpate touch")
      ->check(CLI::IsMember({"keep", "estimate", "face"}))
      ->capture_default_str();
  addLookOptions(*sub, options->look);
  sub->add_option("--size", options->size, "of the window, width x height, pixels")->capture_default_str();
  sub->add_option("--script", options->script,
                  "play timed events: TIME_S key NAME [down|up], mouse X Y, button left|middle|right down|up, wheel N, "
                  "push X Y Z RX RY RZ [BUTTONS], click NAME (in the panels), drop FILE, text WORDS, resize W H, "
                  "minimise, restore, screenshot FILE.png, state FILE.json, save FILE.ply, record [FILE], replay FILE, "
                  "impatient, patient, ask (about changes, and how to save: click Save beside, click Save over), quit; # comments")
      ->type_name("FILE");
  sub->add_flag("--realtime", options->realtime,
                "the script goes by the wall clock, as a device in a hand makes it do; otherwise each picture is 0.05 s "
                "of it, with all the ticks of that time, on the slowest machine, too");
  sub->add_option("--sight-gpu", options->sightGpu, "draw on another GPU: number or part of its name")
      ->type_name("N|NAME");
  sub->add_option("--present", options->present,
                  "how pictures come to the display: swapchain (the GPU presents them), copy (through the host, to an X "
                  "display that the GPU cannot present to: remote desktops), or auto; palpate doctor says which")
      ->check(CLI::IsMember({"auto", "swapchain", "copy"}))
      ->capture_default_str();
  sub->add_option("--device", options->device,
                  "what moves the stylus: mouse (or keys and a gamepad); " + heldDevicesHelp())
      ->check(CLI::Validator(
          [](const std::string& device) {
            return device == "mouse" || isHeldDevice(device)
                       ? std::string()
                       : "'" + device + "' is no device; there is mouse, " + heldDevicesHelp();
          },
          "DEVICE"))
      ->capture_default_str();
  sub->add_option("--scheduler", options->scheduler, "of an OpenHaptics device, as in palpate touch")
      ->check(CLI::IsMember({"device", "own"}))
      ->capture_default_str();
  sub->add_flag("--rumble", options->rumble, "a DualSense on a cable rumbles at each contact");
  sub->add_option("--backend", options->backend,
                  "what answers the hand: vulkan, cpu, or auto (cpu where the GPU is a software driver)")
      ->check(CLI::IsMember({"auto", "vulkan", "cpu"}))
      ->capture_default_str();
  std::vector<std::string> edits{"none"};
  for (const auto& [name, kind] : kBrushKinds) edits.emplace_back(name);
  sub->add_option("--surface", options->surface, "average, sphere or sharp, as in palpate touch")
      ->check(CLI::IsMember(surfaceChoices()))
      ->capture_default_str();
  sub->add_option("--edit", options->edit, "the first tool: none, push, carve, inflate, smooth, grab, paint")
      ->check(CLI::IsMember(std::move(edits)))
      ->capture_default_str();
  sub->add_option("--rate", options->rate_Hz, "ticks per second")
      ->check(between(1, bounds::kMostRate_Hz))
      ->capture_default_str();
  sub->add_option("--undo-memory", options->undoMemory_MiB, "for strokes that can be taken back, MiB")
      ->check(between(bounds::kLeastMemory_MiB, bounds::kMostMemory_MiB))
      ->capture_default_str();
  sub->footer(
      "Hold Space and move the mouse over the model: it is the stylus now. Press the left button to touch, and to "
      "sculpt "
      "once a tool is chosen (keys 2 to 7). H shows all keys.\n");
  sub->callback([&, options] { command = [&context, options] { view(context, *options); }; });
}

}  // namespace palpate
