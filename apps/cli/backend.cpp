#include "apps/cli/backend.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/cli/parse_list.hpp"
#include "engine/core/named_values.hpp"
#include "haptics/session/cuda_backend.hpp"
#include "haptics/session/vulkan_backend.hpp"

namespace palpate {

namespace {

template <class Names>
auto named(const Names& names, std::string_view name) {
  if (const auto value = valueNamed(names, name)) return *value;
  throw UsageError("'{}' is no choice", name);  // the command line has let none through
}

ToolConfig toolConfig(const BackendOptions& options) {
  ToolConfig tool{.kind = named(kToolKinds, options.tool)};
  if (tool.kind == ToolKind::point && options.toolPoints > 1)
    throw UsageError("--tool-points: a point is one; take --tool pad, ball or spatula");
  if (options.toolPoints > 0) tool.points = options.toolPoints;
  if (options.toolSize_mm > 0) tool.size_mm = options.toolSize_mm;
  if (options.toolAxis.empty() || tool.kind == ToolKind::point) return tool;
  const auto axis = parseList<double, 3>(options.toolAxis, ',', "--tool-axis", "X,Y,Z");
  tool.axis = {axis[0], axis[1], axis[2]};
  return tool;
}

// One of several words, of which the help shows the one that is taken unless another is given.
void addChoice(Options& sub, const char* name, std::string& value, std::vector<std::string> values, const char* what) {
  sub.add(name, value, what).check(oneOf(std::move(values))).showDefault();
}

}  // namespace

void addBackendOptions(Options& sub, BackendOptions& options) {
  std::vector<std::string> backends = backendChoices();
  backends.insert(backends.begin(), "auto");
  addChoice(
      sub, "--backend", options.backend, std::move(backends),
      "what answers: vulkan, a GPU; cpu, the same loop in double precision without one; auto, vulkan where there is "
      "a GPU and cpu where there is none but a software driver (the report says which); cuda, for comparison, where "
      "palpate was built with it");
  sub.add("--method", options.method,
          "how neighbours are found on a GPU: fused (default), gather, surface and proxy in one dispatch; "
          "indirect, one launch by the GPU for the buckets that hold points; naive, one for each bucket; "
          "two-step, counts first and the host launches; brute, looks at every point; with cuda " +
              fmt::format("{}", fmt::join(cudaMethods(), ", ")));
  addChoice(
      sub, "--index", options.index, {"incremental", "rebuild"},
      "how the index follows an edit, in the same tick: incremental, at the cost of what the edit touched (edits of "
      "a sixteenth of the points and more still rebuild it), or rebuild, whole (as cpu and cuda always do; the "
      "report says what ran)");
  addIndexOptions(sub, options);
}

void addSurfaceOptions(Options& sub, BackendOptions& options) {
  sub.add("--surface", options.surface,
          "what the points define: average (default), weighted position and normal, which sinks into curvature; "
          "sphere, an algebraic sphere that fits places and normals; sharp, the same with a sense for edges, in "
          "three times the time (cuda has average alone)")
      .check(oneOf(namesOf(kSurfaceKinds)));
  sub.add("--friction", options.friction, "coefficient of a proxy that slides; 0 is none")
      .check(between(0, bounds::kMaxFriction))
      .showDefault();
  addRadiusOption(sub, options);
}

void addRadiusOption(Options& sub, BackendOptions& options) {
  sub.add("--radius", options.radius,
          "support radius of the surface, mm, or auto (4 spacings, place by place where they differ; up to 8 on "
          "flat places of clouds whose points are noisier than an eighth of a spacing, as info measures it)")
      .check(lengthOrAuto())
      .showDefault();
}

void addIndexOptions(Options& sub, BackendOptions& options) {
  addChoice(sub, "--bucket-key", options.bucketKey, {"teschner", "morton"},
            "teschner scatters every cell, morton keeps blocks of cells together in memory");
  addChoice(
      sub, "--sort", options.sort, {"counting", "radix", "radix-lookback"},
      "how the index sorts: counting (gives way to a radix sort where a bucket is crowded), radix, radix-lookback "
      "(where workgroups may wait for one another)");
  sub.addFlag("--deterministic", options.deterministic,
              "bit-identical results run after run; virtual time is so in any case");
  sub.add("--wait", options.wait, "for the GPU: spin, poll or block (default: by driver and cores)")
      .check(oneOf({"spin", "poll", "block"}));
  addChoice(
      sub, "--ahead", options.ahead, {"auto", "on", "off"},
      "submit each question before the hand has moved, so that it waits on the GPU for the place: auto (where the "
      "driver is known for it), on or off");
  const Option cell = sub.add("--cell", options.cell_mm, "edge of a hash cell, mm (default: the support radius)")
                          .check(between(bounds::kShortest_mm, bounds::kLongest_mm));
  sub.add("--grid", options.grid, "hash cells along the longest side, instead of --cell")
      .check(between(1, bounds::kMaxCells))
      .excludes(cell);
}

void addToolOptions(Options& sub, BackendOptions& options) {
  sub.add("--tool", options.tool,
          "what touches: point; or with many points that share the stiffness, pad, round like a fingertip; "
          "ball; spatula, flat and half as wide as long; each point has its own proxy and friction (vulkan with "
          "the method fused, and cpu)")
      .check(oneOf(namesOf(kToolKinds)))
      .showDefault();
  sub.add("--tool-points", options.toolPoints,
          fmt::format("of a pad, ball or spatula (default {})", ToolConfig{}.points))
      .check(wholeBetween(1, static_cast<double>(kMaxToolPoints)))
      .typeName("N");
  sub.add("--tool-size", options.toolSize_mm,
          fmt::format("diameter of a pad or ball, length of a spatula, mm (default {})", ToolConfig{}.size_mm))
      .check(between(bounds::kShortest_mm, bounds::kLongest_mm));
  sub.add("--tool-axis", options.toolAxis,
          "where the face of a pad or spatula looks while the stylus is not turned, X,Y,Z in the model's axes "
          "(default 0,0,-1)")
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
