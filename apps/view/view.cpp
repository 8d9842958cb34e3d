// `palpate view`: the window.
#include "apps/parse_list.hpp"
#include "apps/view/viewer.hpp"
#include "engine/core/thread_priority.hpp"

namespace palpate {

namespace {

struct ViewCommandOptions {
  std::vector<std::string> models;
  double mm_per_unit = 0;
  std::string normals = "keep", size = "1280x720", script, sightGpu, backend = "auto", surface = "average",
              edit = "none";
  double rate_Hz = 1000, undoMemory_MiB = 1024;
};

void view(Context& context, const ViewCommandOptions& options) {
  const auto [width, height] = parseList<std::uint32_t, 2>(options.size, 'x', "--size", "WIDTHxHEIGHT in pixels");
  Frame::checkSize(width, height);
  ViewOptions view{.models = options.models, .size_px = {width, height}};
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

  Window window(view.size_px, "palpate");
  context.showInWindows(window.extensions());
  Device& touch = context.device();
  // A software driver draws with the cores that would answer; the CPU's own way is quicker there.
  view.session.backend.backend = options.backend != "auto" ? options.backend : touch.isCpu() ? "cpu" : "vulkan";
  if (touch.isCpu()) letThreadsGiveWay("llvmpipe");
  Device& sight = options.sightGpu.empty() ? touch : context.sightDevice(options.sightGpu);
  Viewer(context, window, sight, std::move(view)).run();
}

}  // namespace

void addView(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand(
      "view", "the window: feel, see and sculpt at the same time, with a mouse or a gamepad as the stylus");
  auto options = std::make_shared<ViewCommandOptions>();
  sub->add_option("models", options->models, "PLY files; the first one is opened, others can be dropped on the window")
      ->type_name("MODEL...");
  sub->add_option("--mm-per-unit", options->mm_per_unit,
                  "millimetres per model unit (default: the longest side becomes 100 mm)")
      ->check(positive());
  sub->add_option("--normals", options->normals, "keep, estimate or face, as in palpate touch")
      ->check(CLI::IsMember({"keep", "estimate", "face"}))
      ->capture_default_str();
  sub->add_option("--size", options->size, "of the window, width x height, pixels")->capture_default_str();
  sub->add_option("--script", options->script,
                  "play timed events: TIME_S key NAME [down|up], mouse X Y, button left|middle|right down|up, wheel N, "
                  "drop FILE, text WORDS, resize W H, minimise, restore, screenshot FILE.png, state FILE.json, save "
                  "FILE.ply, record [FILE], replay FILE, impatient, quit; # comments")
      ->type_name("FILE");
  sub->add_option("--sight-gpu", options->sightGpu, "draw on another GPU: number or part of its name")
      ->type_name("N|NAME");
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
  sub->add_option("--rate", options->rate_Hz, "ticks per second")->check(between(1, 10'000))->capture_default_str();
  sub->add_option("--undo-memory", options->undoMemory_MiB, "for strokes that can be taken back, MiB")
      ->check(positive())
      ->capture_default_str();
  sub->footer(
      "Hold Space and move the mouse over the model: it is the stylus now. Press the left button to touch, and to "
      "sculpt "
      "once a tool is chosen (keys 2 to 7). H shows all keys.\n");
  sub->callback([&, options] { command = [&context, options] { view(context, *options); }; });
}

}  // namespace palpate
