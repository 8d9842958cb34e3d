#include "haptics/session/session_setup.hpp"

#include <algorithm>
#include <utility>

#include "haptics/session/abilities.hpp"

namespace palpate {

std::optional<MirrorPlane> symmetryOf(const BrushConfig& brush, const Model& model) {
  if (brush.symmetry.empty()) return std::nullopt;
  const DVec3& origin = model.cloud.origin;
  const bool isAxis = brush.symmetry.size() == 1;
  const SymmetryPlane plane = symmetryPlane(brush.symmetry, isAxis ? origin + model.shownBounds().center() : DVec3(0));
  return MirrorPlane{.normal = plane.normal, .height = glm::dot(plane.normal, plane.place - origin)};
}

std::optional<BrushOptions> brushOf(const std::optional<BrushConfig>& brush, const Model& model) {
  if (!brush) return std::nullopt;
  BrushOptions options = brushOptions(*brush, model.scale);
  options.symmetry = symmetryOf(*brush, model);
  return options;
}

std::vector<ToolShape> toolsOf(const SessionConfig& config, const Model& model) {
  std::vector<ToolShape> tools{toolShape(config.tool, model.scale)};
  tools.resize(std::max<std::size_t>(1, config.hands.size()));
  return tools;
}

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
      throw ConfigError("backend.name", "{} requires all points in this program; use vulkan or cpu",
                        config.backend.name);
    std::unique_ptr<FarTouch> touch = far->cloud->makeTouch(setup);
    FarTouch* const same = touch.get();
    return {.touch = std::move(touch), .far = same};
  }
  std::optional<BrushOptions> brush = brushOf(config.brush, model);
  const bool isShared = static_cast<bool>(model.share());
  // Edits of others require editable points, even if this hand has no brush.
  if (isShared && !brush) brush = brushOptions({.resample = false}, model.scale);
  auto touch = setup.kind.make({.model = model,
                                .config = config,
                                .surface = setup.surface,
                                .brush = brush,
                                .paintable = setup.paintable || isShared,
                                .tools = toolsOf(config, model),
                                .threads = setup.threads,
                                .source = setup.source,
                                .fusion = setup.source ? std::nullopt : setup.fusion,
                                .engine = setup.engine});
  if (isShared && !config.brush) touch->setBrush(std::nullopt);
  return {.touch = std::move(touch)};
}

}  // namespace palpate
