#include "apps/cli/backend.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/cli/parse_list.hpp"
#include "apps/cli/setting_options.hpp"
#include "engine/core/named_values.hpp"
#include "haptics/session/backend_choice.hpp"
#include "haptics/study/cuda_backend.hpp"

namespace palpate {

namespace {

template <class Names>
auto named(const Names& names, std::string_view name) {
  if (const auto value = valueNamed(names, name)) return *value;
  throw UsageError("'{}' is not a valid choice", name);  // unreachable: the command line has checked it
}

ToolConfig toolConfig(const BackendOptions& options) {
  ToolConfig tool{.kind = named(kToolKinds, options.tool)};
  if (tool.kind == ToolKind::point && options.toolPoints > 1)
    throw UsageError("--tool-points: requires --tool pad, ball or spatula");
  if (options.toolPoints > 0) tool.points = options.toolPoints;
  if (options.toolSize_mm > 0) tool.size_mm = options.toolSize_mm;
  if (options.toolAxis.empty() || tool.kind == ToolKind::point) return tool;
  const auto axis = parseList<double, 3>(options.toolAxis, ',', "--tool-axis", "X,Y,Z");
  tool.axis = {axis[0], axis[1], axis[2]};
  return tool;
}

// Adds an option with several choices; the help shows the default.
template <class Section>
void addChoice(Options& sub, std::string& value, std::string_view name, std::vector<std::string> before = {}) {
  addSettingFor<Section>(sub, value, name).check(oneOf(choicesOf<Section>(name, std::move(before)))).showDefault();
}

}  // namespace

void addBackendOptions(Options& sub, BackendOptions& options) {
  std::vector<std::string> backends = backendChoices();
  backends.insert(backends.begin(), "auto");
  addSettingFor<BackendConfig>(sub, options.backend, "name").check(oneOf(std::move(backends))).showDefault();
  addSettingFor<BackendConfig>(sub, options.method, "method")
      .describe(
          fmt::format("{}; with cuda: {}", settingNamed<BackendConfig>("method").help, fmt::join(cudaMethods(), ", ")))
      .offers(namesOf(kQueryMethods));
  addChoice<IndexConfig>(sub, options.index, "follow");
  addIndexOptions(sub, options);
}

void addSurfaceOptions(Options& sub, BackendOptions& options) {
  addSettingFor<SurfaceConfig>(sub, options.surface, "kind").check(oneOf(choicesOf<SurfaceConfig>("kind")));
  addSettingFor<SurfaceConfig>(sub, options.friction, "friction").showDefault();
  addRadiusOption(sub, options);
}

void addRadiusOption(Options& sub, BackendOptions& options) {
  addSettingFor<SurfaceConfig>(sub, options.radius, "radius_mm").check(lengthOrAuto()).showDefault();
}

Option addIndexOptions(Options& sub, BackendOptions& options) {
  addChoice<IndexConfig>(sub, options.bucketKey, "bucket_key");
  addSettingFor<BackendConfig>(sub, options.deterministic, "deterministic");
  addChoice<BackendConfig>(sub, options.ahead, "ahead", {"auto"});
  return addSettingFor<IndexConfig>(sub, options.cell_mm, "cell_mm");
}

void addToolOptions(Options& sub, BackendOptions& options) {
  const ToolConfig usual;
  addChoice<ToolConfig>(sub, options.tool, "kind");
  const auto withDefault = [&](Option option, const auto& value) {
    option.describe(fmt::format("{} (default {})", option.help(), value));
    return option;
  };
  withDefault(addSettingFor<ToolConfig>(sub, options.toolPoints, "points"), usual.points).typeName("N");
  withDefault(addSettingFor<ToolConfig>(sub, options.toolSize_mm, "size_mm"), usual.size_mm);
  addSettingFor<ToolConfig>(sub, options.toolAxis, "axis").typeName("X,Y,Z");
}

void setBackend(SessionConfig& config, const BackendOptions& options) {
  config.backend = {.name = options.backend,
                    .method = options.method,
                    .deterministic = options.deterministic,
                    .timesPasses = options.timePasses};
  if (options.ahead != "auto") config.backend.ahead = options.ahead == "on";
  config.index = {.follow = named(kIndexFollows, options.index),
                  .bucketKey = named(kBucketKeys, options.bucketKey),
                  .cell_mm = options.cell_mm};
  config.surface = {.friction = options.friction, .radius_mm = radius_mm(options.radius)};
  if (!options.surface.empty()) config.surface.kind = named(kSurfaceKinds, options.surface);
  config.tool = toolConfig(options);
  config.realtime = options.realtime;
}

ChosenBackend chooseBackend(const Context& context, const BackendOptions& options) {
  if (options.backend != "auto") return {options.backend};
  const bool vulkansMethod =
      std::ranges::any_of(kQueryMethods, [&](const auto& known) { return options.method == known.first; });
  if (vulkansMethod || options.ahead == "on" || options.timePasses) return {"vulkan"};
  if (options.method == "direct" || !context.hasRealGpu()) return {"cpu"};
  return {.name = "vulkan", .isOpen = !context.asksForGpu()};
}

std::string soonerBackend(Context& context, const SessionConfig& config, const Model& model,
                          const std::optional<BrushConfig>& laterBrush) {
  const Backends& backends = context.backends();
  return std::string(soonerBackend(config, model,
                                   {.gpu = backends.named("vulkan"),
                                    .cpu = backends.named("cpu"),
                                    .threads = context.threads(),
                                    .log = context.log(),
                                    .laterBrush = laterBrush})
                         .name());
}

std::vector<std::string> backendChoices() { return {"vulkan", "cuda", "cpu"}; }

void checkBackendOptions(const Context& context, const BackendOptions& options) {
  SessionConfig config;
  setBackend(config, options);
  context.backends().named(config.backend.name).check(config);
}

}  // namespace palpate
