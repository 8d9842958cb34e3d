#include "apps/backend.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/cuda_backend.hpp"
#include "apps/parse_list.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/processor.hpp"
#include "engine/touch/cpu_touch.hpp"

namespace palpate {

namespace {

double cellFor(const Model& model, const BackendOptions& options) {
  if (options.cell_mm > 0) return model.scale.toUnits(options.cell_mm);
  if (options.grid > 0) return boundsOf(model.cloud).longestSide() / options.grid;
  return 0;
}

BucketKey bucketKey(const BackendOptions& options) {
  return options.bucketKey == "morton" ? BucketKey::morton : BucketKey::teschner;
}

TouchOptions touchOptions(const Model& model, const BackendOptions& options, const std::optional<BrushOptions>& push) {
  const SurfaceOptions surface = surfaceOptions(model, options);
  TouchOptions touch{.radius = surface.radius,
                     .cell = cellFor(model, options),
                     .surface = surface.kind,
                     .localRadius = surface.localRadius,
                     .widening = surface.widening,
                     .friction = options.friction,
                     .tool = toolShape(options, model.scale),
                     .secondHand = options.secondHand,
                     .brush = push,
                     .paintable = options.paintable,
                     .spareSlots = options.spareSlots};
  touch.bucketKey = bucketKey(options);
  touch.index = options.index == "rebuild" ? IndexFollow::rebuild : IndexFollow::incremental;
  for (const auto& [name, method] : kQueryMethods)
    if (options.method == name) touch.method = method;
  if (options.sort == "radix") touch.sort = SortMethod::radix;
  if (options.sort == "radix-lookback") touch.sort = SortMethod::radixLookBack;
  if (options.realtime && !options.deterministic) touch.bucketOrder = BucketOrder::arrival;
  if (options.wait == "spin") touch.wait = Wait::spin;
  if (options.wait == "poll") touch.wait = Wait::poll;
  if (options.wait == "block") touch.wait = Wait::block;
  if (options.ahead != "auto") touch.ahead = options.ahead == "on";
  if (options.timePasses) touch.timing = CommandList::Timing::passes;
  return touch;
}

}  // namespace

void addBackendOptions(CLI::App& sub, BackendOptions& options) {
  const auto choice = [&](const char* name, std::string& value, std::vector<std::string> values, const char* what) {
    sub.add_option(name, value, what)->check(CLI::IsMember(std::move(values)))->capture_default_str();
  };
  std::vector<std::string> backends = backendChoices();
  backends.insert(backends.begin(), "auto");
  choice("--backend", options.backend, std::move(backends),
         "what answers: vulkan, a GPU; cpu, the same loop in double precision without one; auto, vulkan where there is "
         "a GPU and cpu where there is none but a software driver (the report says which); cuda, for comparison, where "
         "palpate was built with it");
  sub.add_option("--method", options.method,
                 "how neighbours are found on a GPU: fused (default), gather, surface and proxy in one dispatch; "
                 "indirect, one launch by the GPU for the buckets that hold points; naive, one for each bucket; "
                 "two-step, counts first and the host launches; brute, looks at every point; with cuda " +
                     fmt::format("{}", fmt::join(cudaMethods(), ", ")));
  choice("--index", options.index, {"incremental", "rebuild"},
         "how the index follows an edit, in the same tick: incremental, at the cost of what the edit touched (edits of "
         "a sixteenth of the points and more still rebuild it), or rebuild, whole (as cpu and cuda always do; the "
         "report says what ran)");
  addIndexOptions(sub, options);
}

void addSurfaceOptions(CLI::App& sub, BackendOptions& options) {
  sub.add_option("--surface", options.surface,
                 "what the points define: average (default), weighted position and normal, which sinks into curvature; "
                 "sphere, an algebraic sphere that fits places and normals; sharp, the same with a sense for edges, in "
                 "three times the time (cuda has average alone)")
      ->check(CLI::IsMember(surfaceChoices()));
  sub.add_option("--friction", options.friction, "coefficient of a proxy that slides; 0 is none")
      ->check(between(0, bounds::kMostFriction))
      ->capture_default_str();
  addRadiusOption(sub, options);
}

void addRadiusOption(CLI::App& sub, BackendOptions& options) {
  sub.add_option("--radius", options.radius,
                 "support radius of the surface, mm, or auto (4 spacings, place by place where they differ; up to 8 on "
                 "flat places of clouds whose points are noisier than an eighth of a spacing, as info measures it)")
      ->check(lengthOrAuto())
      ->capture_default_str();
}

void addIndexOptions(CLI::App& sub, BackendOptions& options) {
  const auto choice = [&](const char* name, std::string& value, std::vector<std::string> values, const char* what) {
    sub.add_option(name, value, what)->check(CLI::IsMember(std::move(values)))->capture_default_str();
  };
  choice("--bucket-key", options.bucketKey, {"teschner", "morton"},
         "teschner scatters every cell, morton keeps blocks of cells together in memory");
  choice("--sort", options.sort, {"counting", "radix", "radix-lookback"},
         "how the index sorts: counting (gives way to a radix sort where a bucket is crowded), radix, radix-lookback "
         "(where workgroups may wait for one another)");
  sub.add_flag("--deterministic", options.deterministic,
               "bit-identical results run after run; virtual time is so in any case");
  sub.add_option("--wait", options.wait, "for the GPU: spin, poll or block (default: by driver and cores)")
      ->check(CLI::IsMember({"spin", "poll", "block"}));
  choice("--ahead", options.ahead, {"auto", "on", "off"},
         "submit each question before the hand has moved, so that it waits on the GPU for the place: auto (where the "
         "driver is known for it), on or off");
  auto* cell = sub.add_option("--cell", options.cell_mm, "edge of a hash cell, mm (default: the support radius)")
                   ->check(between(bounds::kShortest_mm, bounds::kLongest_mm));
  sub.add_option("--grid", options.grid, "hash cells along the longest side, instead of --cell")
      ->check(between(1, bounds::kMostCells))
      ->excludes(cell);
}

void addToolOptions(CLI::App& sub, BackendOptions& options) {
  std::vector<std::string> tools;
  for (const auto& [name, kind] : kToolKinds) tools.emplace_back(name);
  sub.add_option("--tool", options.tool,
                 "what touches: point; or with many points that share the stiffness, pad, round like a fingertip; "
                 "ball; spatula, flat and half as wide as long; each point has its own proxy and friction (vulkan with "
                 "the method fused, and cpu)")
      ->check(CLI::IsMember(std::move(tools)))
      ->capture_default_str();
  sub.add_option("--tool-points", options.toolPoints,
                 fmt::format("of a pad, ball or spatula (default {})", kUsualToolPoints))
      ->check(wholeBetween(1, static_cast<double>(kMostToolPoints)))
      ->type_name("N");
  sub.add_option("--tool-size", options.toolSize_mm,
                 fmt::format("diameter of a pad or ball, length of a spatula, mm (default {})", kUsualToolSize_mm))
      ->check(between(bounds::kShortest_mm, bounds::kLongest_mm));
  sub.add_option("--tool-axis", options.toolAxis,
                 "where the face of a pad or spatula looks while the stylus is not turned, X,Y,Z in the model's axes "
                 "(default 0,0,-1)")
      ->type_name("X,Y,Z");
}

ToolShape toolShape(const BackendOptions& options, const ModelScale& scale) {
  ToolKind kind = ToolKind::point;
  for (const auto& [name, known] : kToolKinds)
    if (options.tool == name) kind = known;
  if (kind == ToolKind::point) {
    if (options.toolPoints > 1) throw UsageError("--tool-points: a point is one; take --tool pad, ball or spatula");
    return {};
  }
  const double size_mm = options.toolSize_mm > 0 ? options.toolSize_mm : kUsualToolSize_mm;
  ToolShape tool =
      makeTool(kind, options.toolPoints > 0 ? options.toolPoints : kUsualToolPoints, scale.toUnits(size_mm));
  if (tool.points.size() == 1) return {};
  if (options.toolAxis.empty()) return tool;
  const auto axis = parseList<double, 3>(options.toolAxis, ',', "--tool-axis", "X,Y,Z");
  return facing(std::move(tool), {axis[0], axis[1], axis[2]});
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

std::vector<std::string> surfaceChoices() {
  std::vector<std::string> surfaces;
  for (const auto& [name, kind] : kSurfaceKinds) surfaces.emplace_back(name);
  return surfaces;
}

std::vector<std::string> methodChoices(std::string_view backend) {
  if (backend == "cpu") return {"direct"};
  if (backend == "cuda") return cudaMethods();
  std::vector<std::string> methods;
  for (const auto& [name, method] : kQueryMethods) methods.insert(methods.begin(), std::string(name));
  return methods;
}

void checkBackendOptions(const BackendOptions& options) {
  const auto methods = methodChoices(options.backend);
  if (!options.method.empty() && std::ranges::find(methods, options.method) == methods.end())
    throw UsageError("--method: {} is none of --backend {}, which has {}", options.method, options.backend,
                     fmt::join(methods, ", "));
  if (options.backend == "cuda" && !options.surface.empty() && options.surface != "average")
    throw UsageError("--surface: --backend cuda has only average; take vulkan or cpu for {}", options.surface);
  if (options.backend == "cuda" && options.friction > 0)
    throw UsageError("--friction: --backend cuda has none; take vulkan or cpu");
  if (!toolShape(options, {}).points.empty()) {
    if (options.backend == "cuda")
      throw UsageError("--tool: --backend cuda has only point; take vulkan or cpu for {}", options.tool);
    if (methodName(options) != "fused" && options.backend == "vulkan")
      throw UsageError("--tool: --method {} has only point; take fused for {}", options.method, options.tool);
    if (options.ahead == "on") throw UsageError("--ahead: a {} is not asked ahead; leave it out", options.tool);
  }
  if (options.backend == "vulkan") return;
  if (options.ahead != "auto") throw UsageError("--ahead: only --backend vulkan can be asked ahead");
  if (!options.wait.empty()) throw UsageError("--wait: only --backend vulkan can be told how to wait");
  if (options.timePasses) throw UsageError("--print-tick: only --backend vulkan knows its passes");
}

std::string methodName(const BackendOptions& options) {
  if (!options.method.empty()) return options.method;
  return options.backend == "cpu" ? "direct" : "fused";
}

EstimateOn estimateOn(const BackendOptions& options) {
  return options.backend == "vulkan" ? EstimateOn::gpu : EstimateOn::cpu;
}

SurfaceOptions surfaceOptions(const Model& model, const BackendOptions& options) {
  // An even cloud needs no look at the local spacing; past four times the mean a patch of the dense places is too
  // large.
  constexpr double kUneven = 1.4, kWidest = 4;
  const bool adapts = options.radius == "auto" && options.backend != "cuda";
  SurfaceOptions surface{.radius = supportRadius(options.radius, model)};
  for (const auto& [name, kind] : kSurfaceKinds)
    if (options.surface == name) surface.kind = kind;
  if (adapts) surface.widening = wideningFor(model.noise);
  surface.localRadius = adapts && model.wideSpacing > kUneven * model.spacing;
  if (surface.localRadius) surface.radius *= std::min(kWidest / surface.widening, model.wideSpacing / model.spacing);
  surface.radius *= surface.widening;
  return surface;
}

std::string machineOf(Context& context, std::string_view backend) {
  if (backend == "cpu") return fmt::format("{}, {} threads", processorName(), threadCount(context.threads()));
  if (backend == "cuda") return cudaMachine();
  return context.device().name();
}

HashGrid gridFor(const Model& model, const BackendOptions& options) {
  const double radius = surfaceOptions(model, options).radius;
  const double cell = cellFor(model, options);
  return makeHashGrid(Vec3(boundsOf(model.cloud).min), std::max(cell > 0 ? cell : radius, smallestCell(radius)),
                      model.cloud.size(), bucketKey(options));
}

std::unique_ptr<TouchBackend> makeBackend(Context& context, const Model& model, const BackendOptions& options,
                                          const std::optional<BrushOptions>& push) {
  if (options.backend == "cpu") {
    const SurfaceOptions surface = surfaceOptions(model, options);
    return std::make_unique<CpuTouch>(model.cloud, CpuTouchOptions{.radius = surface.radius,
                                                                   .cell = cellFor(model, options),
                                                                   .bucketKey = bucketKey(options),
                                                                   .surface = surface.kind,
                                                                   .localRadius = surface.localRadius,
                                                                   .widening = surface.widening,
                                                                   .friction = options.friction,
                                                                   .tool = toolShape(options, model.scale),
                                                                   .brush = push,
                                                                   .threads = context.threads()});
  }
  const TouchOptions touch = touchOptions(model, options, push);
  if (options.backend == "cuda") return makeCudaBackend(model, touch, methodName(options));
  return std::make_unique<TouchSide>(context.device(), model.cloud, touch);
}

}  // namespace palpate
