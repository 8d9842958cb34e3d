#include "apps/cli/backend.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/cli/parse_list.hpp"
#include "engine/core/named_values.hpp"
#include "haptics/session/vulkan_backend.hpp"
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
void addChoice(Options& sub, const char* name, std::string& value, std::vector<std::string> values, const char* what) {
  sub.add(name, value, what).check(oneOf(std::move(values))).showDefault();
}

}  // namespace

void addBackendOptions(Options& sub, BackendOptions& options) {
  std::vector<std::string> backends = backendChoices();
  backends.insert(backends.begin(), "auto");
  addChoice(sub, "--backend", options.backend, std::move(backends),
            "back end: vulkan (a GPU), cpu (double precision), cuda (for comparison, where built in), or "
            "auto (vulkan where there is a GPU other than a software driver, else cpu)");
  sub.add("--method", options.method,
          "neighbour search on the GPU: fused (default; search, surface and proxy in one dispatch), indirect (one "
          "indirect dispatch for the occupied buckets), naive (one per bucket), two-step (counts first, dispatched by "
          "the host), or brute (every point); with cuda: " +
              fmt::format("{}", fmt::join(cudaMethods(), ", ")));
  addChoice(sub, "--index", options.index, {"incremental", "rebuild"},
            "how the index follows an edit: incremental (cost of the touched points; rebuilt when a "
            "sixteenth of all is touched), or rebuild (always so on cpu and cuda)");
  addIndexOptions(sub, options);
}

void addSurfaceOptions(Options& sub, BackendOptions& options) {
  sub.add("--surface", options.surface,
          "implicit surface: average (default; weighted position and normal), sphere (algebraic sphere "
          "through positions and normals), or sharp (keeps edges, three times the cost); cuda has "
          "average only")
      .check(oneOf(namesOf(kSurfaceKinds)));
  sub.add("--friction", options.friction, "Coulomb friction coefficient of the proxy; 0: frictionless")
      .check(between(0, bounds::kMaxFriction))
      .showDefault();
  addRadiusOption(sub, options);
}

void addRadiusOption(Options& sub, BackendOptions& options) {
  sub.add("--radius", options.radius,
          "support radius of the surface, mm, or auto (4 local spacings; up to 8 on flat parts of noisy "
          "clouds)")
      .check(lengthOrAuto())
      .showDefault();
}

void addIndexOptions(Options& sub, BackendOptions& options) {
  addChoice(sub, "--bucket-key", options.bucketKey, {"teschner", "morton"},
            "hash key: teschner scatters the cells, morton keeps neighbouring cells together in memory");
  addChoice(sub, "--sort", options.sort, {"counting", "radix", "radix-lookback"},
            "sort of the index: counting (falls back to radix for crowded buckets), radix, or "
            "radix-lookback (requires forward progress between workgroups)");
  sub.addFlag("--deterministic", options.deterministic,
              "bit-identical results in every run (always so in virtual time)");
  sub.add("--wait", options.wait,
          "how the CPU waits for the GPU: spin, poll or block (default: depends on driver and core "
          "count)")
      .check(oneOf({"spin", "poll", "block"}));
  addChoice(sub, "--ahead", options.ahead, {"auto", "on", "off"},
            "submit each query before its pose is known, so that the GPU only waits for the pose: auto "
            "(on for drivers known to allow it), on or off");
  const Option cell = sub.add("--cell", options.cell_mm, "edge of a hash cell, mm (default: the support radius)")
                          .check(between(bounds::kShortest_mm, bounds::kLongest_mm));
  sub.add("--grid", options.grid, "hash cells along the longest side, in place of --cell")
      .check(between(1, bounds::kMaxCells))
      .excludes(cell);
}

void addToolOptions(Options& sub, BackendOptions& options) {
  sub.add("--tool", options.tool,
          "tool: point, or many contact points that share the stiffness: pad (a fingertip), ball, or "
          "spatula; vulkan with the method fused, or cpu")
      .check(oneOf(namesOf(kToolKinds)))
      .showDefault();
  sub.add("--tool-points", options.toolPoints,
          fmt::format("contact points of a pad, ball or spatula (default {})", ToolConfig{}.points))
      .check(wholeBetween(1, static_cast<double>(kMaxToolPoints)))
      .typeName("N");
  sub.add("--tool-size", options.toolSize_mm,
          fmt::format("diameter of a pad or ball, length of a spatula, mm (default {})", ToolConfig{}.size_mm))
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm));
  sub.add("--tool-axis", options.toolAxis,
          "direction in which the face of a pad or spatula looks while the stylus is not rotated, model "
          "axes (default 0,0,-1)")
      .typeName("X,Y,Z");
}

void setBackend(SessionConfig& config, const BackendOptions& options) {
  config.backend = {.name = options.backend,
                    .method = options.method,
                    .deterministic = options.deterministic,
                    .timesPasses = options.timePasses};
  if (!options.wait.empty()) config.backend.wait = named(kWaits, options.wait);
  if (options.ahead != "auto") config.backend.ahead = options.ahead == "on";
  config.index = {.follow = named(kIndexFollows, options.index),
                  .bucketKey = named(kBucketKeys, options.bucketKey),
                  .sort = named(kSortMethods, options.sort),
                  .cell_mm = options.cell_mm,
                  .cellsAlongSide = options.grid,
                  .spareSlots = options.spareSlots};
  config.surface = {.friction = options.friction, .radius_mm = radius_mm(options.radius)};
  if (!options.surface.empty()) config.surface.kind = named(kSurfaceKinds, options.surface);
  config.tool = toolConfig(options);
  config.realtime = options.realtime;
}

std::string chooseBackend(const Context& context, const BackendOptions& options) {
  if (options.backend != "auto") return options.backend;
  const bool vulkansMethod =
      std::ranges::any_of(kQueryMethods, [&](const auto& known) { return options.method == known.first; });
  if (vulkansMethod || !options.wait.empty() || options.ahead == "on" || options.timePasses) return "vulkan";
  if (options.method == "direct") return "cpu";
  return context.hasRealGpu() ? "vulkan" : "cpu";
}

std::vector<std::string> backendChoices() { return {"vulkan", "cuda", "cpu"}; }

void checkBackendOptions(const Context& context, const BackendOptions& options) {
  SessionConfig config;
  setBackend(config, options);
  context.backends().named(config.backend.name).check(config);
}

SurfaceOptions surfaceOptions(Context& context, const Model& model, const BackendOptions& options) {
  SessionConfig config;
  setBackend(config, options);
  return context.backends().named(options.backend).surface(model, config.surface);
}

HashGrid gridFor(Context& context, const Model& model, const BackendOptions& options) {
  SessionConfig config;
  setBackend(config, options);
  return gridFor(model, config.index, surfaceOptions(context, model, options).radius);
}

}  // namespace palpate
