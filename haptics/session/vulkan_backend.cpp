#include "haptics/session/vulkan_backend.hpp"

#include <algorithm>

#include "engine/contact/neighbour_distances.hpp"
#include "engine/contact/normal_estimate.hpp"
#include "engine/contact/query_method.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/named_values.hpp"
#include "engine/gpu/device.hpp"
#include "engine/touch/touch_side.hpp"

namespace palpate {

namespace {

// An idle H100, at 345 MHz, answered at its usual rate after 0.7 s.
constexpr double kWarmUp_s = 1;

class VulkanBackend final : public BackendKind {
 public:
  VulkanBackend(std::function<Device&()> device, ProveGpu prove)
      : device_(std::move(device)), prove_(std::move(prove)), simulator_(gpuSimulator(device_)) {}

  std::string_view name() const override { return "vulkan"; }
  const std::vector<std::string>& methods() const override {
    static const std::vector<std::string> methods = namesOf(builtMethods());
    return methods;
  }
  bool hasInStudy(std::string_view method) const override { return valueNamed(kQueryMethods, method).has_value(); }
  TouchCapabilities capabilities() const override {
    return {.fusesFrames = true, .asksAhead = true, .timesPasses = true, .methodOfMany = "fused"};
  }
  std::string machine(unsigned) const override { return device_().name(); }
  std::string identity(unsigned) const override {
    return fmt::format("{}, driver {:#x}", device_().name(), device_().properties().driverVersion);
  }
  double warmUp_s() const override { return device_().isCpu() ? 0 : kWarmUp_s; }
  NormalEstimator normalEstimator() const override { return estimateNormalsOn(device_); }
  const Simulator* simulator() const override { return simulator_.get(); }
  void requireProof() const override {
    Device& gpu = device_();
    const std::string wrong = prove_(gpu);
    if (wrong.empty()) return;
    const auto substitute = GpuProofs().substitute(gpu);
    throw GpuError("{} may not move a hand: {} (palpate doctor --prove shows it); {}", gpu.name(),
                   wrong == kNoProof ? "its driver did not end a proof" : "wrong results of " + wrong,
                   substitute ? fmt::format("it is right with subgroups of {}, which the next start uses", *substitute)
                              : "use the back end cpu");
  }
  std::unique_ptr<TouchBackend> make(const BackendRequest& request) const override {
    if (request.config.realtime) requireProof();
    if (request.config.model.matter && !request.source) return request.config.model.matter->touch(*this, request);
    return std::make_unique<TouchSide>(device_(), request.model.cloud, optionsFor(request));
  }

 private:
  TouchOptions optionsFor(const BackendRequest& request) const {
    const SessionConfig& config = request.config;
    TouchOptions touch{.radius = request.surface.radius,
                       .cell = request.model.scale.toUnits(config.index.cell_mm),
                       .bucketKey = config.index.bucketKey,
                       .sort = request.engine.sort,
                       .method = queryMethodNamed(methodOf(config.backend)),
                       .surface = request.surface.kind,
                       .localRadius = request.surface.localRadius,
                       .widening = request.surface.widening,
                       .friction = config.surface.friction,
                       .tools = request.tools,
                       .brush = request.brush,
                       .source = request.source,
                       .extent = request.model.extent(),
                       .fusion = request.fusion,
                       .paintable = request.paintable,
                       .index = config.index.follow,
                       .spareSlots = request.engine.spareSlots,
                       .wait = request.engine.wait,
                       .ahead = config.backend.ahead};
    if (config.realtime && !config.backend.deterministic) touch.bucketOrder = BucketOrder::arrival;
    if (config.backend.timesPasses) touch.timing = CommandList::Timing::passes;
    return touch;
  }

  std::function<Device&()> device_;
  ProveGpu prove_;
  std::unique_ptr<Simulator> simulator_;
};

}  // namespace

std::unique_ptr<BackendKind> vulkanBackend(std::function<Device&()> device, ProveGpu prove) {
  return std::make_unique<VulkanBackend>(std::move(device), std::move(prove));
}

HashGrid gridFor(const Model& model, const IndexConfig& config, double radius) {
  const double cell = model.scale.toUnits(config.cell_mm);
  return makeHashGrid(Vec3(boundsOf(model.cloud).min), std::max(cell > 0 ? cell : radius, smallestCell(radius)),
                      model.cloud.size(), config.bucketKey);
}

NormalEstimator estimateNormalsOn(std::function<Device&()> device) {
  return [device = std::move(device)](PointCloud& cloud, unsigned threads, std::optional<UpAxis> up) {
    if (device().isCpu()) return estimateNormalsOnCpu(cloud, threads, up);
    try {
      const NormalEstimateCost cost = estimateNormals(device(), cloud, threads, up);
      return fmt::format("planes {:.0f} ms on {}, signs {:.0f} ms on the CPU", cost.planes_ms, device().name(),
                         cost.signs_ms);
    } catch (const OutOfGpuMemory&) {
      return estimateNormalsOnCpu(cloud, threads, up);
    }
  };
}

Cleaners cleanersOn(const std::function<Device&()>& device) {
  const auto isLarge = [](const PointCloud& cloud) { return cloud.size() >= Cleaners::kFewestOnGpu; };
  const auto estimate = [=, onGpu = estimateNormalsOn(device)](PointCloud& cloud, unsigned threads,
                                                               std::optional<UpAxis> up) {
    return isLarge(cloud) ? onGpu(cloud, threads, up) : estimateNormalsOnCpu(cloud, threads, up);
  };
  const auto distances = [=](const PointCloud& cloud, std::uint32_t neighbours, unsigned threads) {
    return isLarge(cloud) ? neighbourDistances(device(), cloud, neighbours, threads) : std::nullopt;
  };
  return {estimate, distances};
}

}  // namespace palpate
