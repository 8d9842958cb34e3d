#include "haptics/session/backends.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "engine/core/named_values.hpp"
#include "engine/core/unknown_name.hpp"
#include "haptics/session/abilities.hpp"

namespace palpate {

namespace {

void checkTool(const SessionConfig& config, const TouchCapabilities& can, std::string_view backend,
               std::string_view method) {
  if (toolShape(config.tool, {}).points.empty()) return;
  const std::string_view tool = nameOf(kToolKinds, config.tool.kind);
  if (!can.manyPoints)
    throw ConfigError("tool.kind", "backend.name {} supports only the tool point; use vulkan or cpu for {}", backend,
                      tool);
  if (!can.methodOfMany.empty() && method != can.methodOfMany)
    throw ConfigError("tool.kind", "backend.method {} supports only the tool point; use {} for {}", method,
                      can.methodOfMany, tool);
  if (config.backend.ahead == true)
    throw ConfigError("backend.ahead", "queries with a {} cannot be submitted ahead; leave it out", tool);
}

void checkHands(const SessionConfig& config, const TouchCapabilities& can, std::string_view backend,
                std::string_view method) {
  if (config.hands.size() < 2) return;
  if (!can.manyHands) throw ConfigError("hands", "backend.name {} supports one hand; use vulkan or cpu", backend);
  if (!can.methodOfMany.empty() && method != can.methodOfMany)
    throw ConfigError("hands", "backend.method {} supports one hand; use {}", method, can.methodOfMany);
  if (config.backend.ahead == true)
    throw ConfigError("backend.ahead", "queries of several hands cannot be submitted ahead; leave it out");
}

}  // namespace

void BackendKind::check(const SessionConfig& config) const {
  const TouchCapabilities can = capabilities();
  const std::string method = methodOf(config.backend);
  const bool hasMethod = std::ranges::find(methods(), method) != methods().end();
  if (!hasMethod && hasInStudy(method))
    throw ConfigError("backend.method", "{} needs PALPATE_STUDY, which this palpate was built without", method);
  if (!hasMethod)
    throw ConfigError("backend.method", "{} is not a method of backend.name {}, which has {}", method, name(),
                      fmt::join(methods(), ", "));
  if (!can.allSurfaces && config.surface.kind != SurfaceKind::average)
    throw ConfigError("surface.kind", "backend.name {} supports only the surface average; use vulkan or cpu for {}",
                      name(), nameOf(kSurfaceKinds, config.surface.kind));
  checkTool(config, can, name(), method);
  if (!can.asksAhead && config.backend.ahead)
    throw ConfigError("backend.ahead", "only backend.name vulkan supports it");
  if (!can.timesPasses && config.backend.timesPasses)
    throw ConfigError("backend.times_passes", "only backend.name vulkan supports it");
  checkHands(config, can, name(), method);
  if (!can.allBrushes && config.brush && config.brush->kind != BrushKind::push)
    throw ConfigError("brush.kind", "backend.name {} supports only the brush push; use vulkan or cpu for {}", name(),
                      nameOf(kBrushKinds, config.brush->kind));
  if (!can.followsMotion && config.motion)
    throw ConfigError("motion.kind", "backend.name {} requires a model at rest; use vulkan or cpu", name());
  if (!can.followsMotion && config.model.stream)
    throw ConfigError("backend.name", "{} requires a model at rest; use vulkan or cpu for a depth camera", name());
  if (!can.followsMotion && config.model.matter)
    throw ConfigError("backend.name", "{} requires a model at rest; use vulkan or cpu for matter", name());
  if (config.model.matter) config.model.matter->check(*this);
  const Abilities abilities(modelKindOf(config), can, name());
  if (config.undo.undo > 0 && !abilities.allow(Action::undo))
    throw ConfigError("undo.undo", "{}", abilities.refusal(Action::undo));
}

const BackendKind& Backends::named(std::string_view name) const {
  for (const auto& kind : kinds_)
    if (kind->name() == name) return *kind;
  throw ConfigError("backend.name", "{}", unknownName("back end", name, names()));
}

std::vector<std::string> Backends::names() const {
  std::vector<std::string> names;
  for (const auto& kind : kinds_) names.emplace_back(kind->name());
  return names;
}

}  // namespace palpate
