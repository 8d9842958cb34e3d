#include "haptics/session/session_setup.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/parallel.hpp"
#include "engine/matter/matter_pond.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/motion/brick_source.hpp"
#include "engine/touch/brick_matter.hpp"
#include "engine/touch/matter_touch.hpp"
#include "haptics/session/abilities.hpp"

namespace palpate {

namespace {

std::optional<BrushOptions> brushOf(const SessionConfig& config, const Model& model) {
  if (!config.brush) return std::nullopt;
  return brushOptions(*config.brush, model.scale);
}

// Only the first hand has the tool.
std::vector<ToolShape> toolsOf(const SessionConfig& config, const Model& model) {
  std::vector<ToolShape> tools{toolShape(config.tool, model.scale)};
  tools.resize(std::max<std::size_t>(1, config.hands.size()));
  return tools;
}

// Matter that another program simulates: the particles around the hands are simulated here, on the CPU.
std::unique_ptr<BrickTouch> makePond(const BackendSetup& setup) {
  const SessionConfig& config = setup.config;
  const Model& model = setup.model;
  if (config.tool.kind != ToolKind::point) throw ConfigError("tool.kind", "in matter a hand holds the scene's ball");
  const MatterScene& scene = *model.as<FarPoints>()->scene;
  const std::size_t hands = std::max<std::size_t>(1, config.hands.size());
  BrickSource& source = model.far()->source();
  // Some thousand particles, two or more steps per millisecond: threads that wait for one another need a core each.
  constexpr unsigned kMaxThreads = 4;
  const unsigned threads = std::clamp(threadCount(setup.threads) / kMaxThreads, 1U, kMaxThreads);
  constexpr std::uint64_t kMemory_bytes = std::uint64_t{1} << 32;  // limit for a scene from another program
  auto pond = std::make_unique<MatterPond>(
      scene,
      MatterOptions{
          .threads = threads, .tools = hands, .memory_bytes = kMemory_bytes, .model = model.fluid()->standing},
      newsOf(source));
  auto felt =
      std::make_unique<MatterTouch>(std::move(pond), MatterTouchOptions{.hands = hands,
                                                                        .threads = setup.threads,
                                                                        .realtime = true,
                                                                        .machine = cpuBackend()->machine(threads),
                                                                        .varies = true});
  // Reach of the weights.
  const double support = kSupport_spacings * particleSpacing_mm(scene);
  return std::make_unique<BrickTouch>(source, std::move(felt),
                                      BrickTouchOptions{.radius = support,
                                                        .tool = scene.tool.radius_mm,
                                                        .origin = model.cloud.origin,
                                                        .brush = brushOf(config, model),
                                                        .fixed = fixedBecause(config, model)});
}

// A cloud that another program has: only its points around the hands are here and felt.
std::unique_ptr<BrickTouch> makeFarBackend(const BackendSetup& setup) {
  const SessionConfig& config = setup.config;
  const Model& model = setup.model;
  const SurfaceOptions& surface = setup.surface;
  std::vector<ToolShape> tools = toolsOf(config, model);
  double reach = 0;
  for (const ToolPoint& point : tools.front().points) reach = std::max(reach, glm::length(point.place));
  BrickSource& source = model.far()->source();
  auto felt = setup.kind.make({.model = model,
                               .config = config,
                               .surface = surface,
                               .brush = std::nullopt,
                               .tools = std::move(tools),
                               .threads = setup.threads,
                               .source = &source,
                               .fusion = std::nullopt});
  return std::make_unique<BrickTouch>(source, std::move(felt),
                                      BrickTouchOptions{.radius = surface.radius,
                                                        .widening = surface.widening,
                                                        .tool = reach,
                                                        .origin = model.cloud.origin,
                                                        .brush = brushOf(config, model),
                                                        .fixed = fixedBecause(config, model)});
}

}  // namespace

SessionConfig checked(SessionConfig config, const BackendKind& kind) {
  validate(config);
  kind.check(config);
  return config;
}

std::string fixedBecause(const SessionConfig& config, const Model& model) {
  const Abilities can(modelKindOf(config, model));
  if (can.allow(Action::sculpt)) return {};
  return fmt::format("{}: {}", config.model.file, can.refusal(Action::sculpt));
}

MadeBackend makeBackend(const BackendSetup& setup) {
  const SessionConfig& config = setup.config;
  const Model& model = setup.model;
  if (const FarPoints* const far = model.as<FarPoints>()) {
    if (!setup.kind.capabilities().followsMotion)
      throw ConfigError("backend.name", "{} requires all points in this program; take vulkan or cpu",
                        config.backend.name);
    std::unique_ptr<BrickTouch> touch = far->scene ? makePond(setup) : makeFarBackend(setup);
    BrickTouch* const bricks = touch.get();
    return {.touch = std::move(touch), .bricks = bricks};
  }
  std::optional<BrushOptions> brush = brushOf(config, model);
  const bool isShared = static_cast<bool>(model.share());
  // Edits of others require editable points, even if this hand has no brush.
  if (isShared && !brush) brush = brushOptions({.keepsDensity = false}, model.scale);
  // Allocates for any later brush, which may keep the density.
  std::optional<BrushOptions> widest = brush;
  if (widest && !isShared) widest->keepsDensity = true;
  auto touch = setup.kind.make({.model = model,
                                .config = config,
                                .surface = setup.surface,
                                .brush = widest,
                                .paintable = setup.paintable || isShared,
                                .tools = toolsOf(config, model),
                                .threads = setup.threads,
                                .source = setup.source,
                                .fusion = setup.source ? std::nullopt : setup.fusion});
  if (brush && widest->keepsDensity != brush->keepsDensity) touch->setBrush(brush);
  if (isShared && !config.brush) touch->setBrush(std::nullopt);
  return {.touch = std::move(touch)};
}

}  // namespace palpate
