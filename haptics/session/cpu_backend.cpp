#include "engine/core/parallel.hpp"
#include "engine/core/processor.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

class CpuBackend final : public BackendKind {
 public:
  std::string_view name() const override { return "cpu"; }
  const std::vector<std::string>& methods() const override {
    static const std::vector<std::string> methods{"direct"};
    return methods;
  }
  const Simulator* simulator() const override { return simulator_.get(); }
  std::string machine(unsigned threads) const override {
    return fmt::format("{}, {} threads", processorName(), threadCount(threads));
  }
  std::unique_ptr<TouchBackend> make(const BackendRequest& request) const override {
    const SessionConfig& config = request.config;
    if (config.model.matter && !request.source) return config.model.matter->touch(*this, request);
    const double cell = request.model.scale.toUnits(config.index.cell_mm);
    return std::make_unique<CpuTouch>(request.model.cloud, CpuTouchOptions{.radius = request.surface.radius,
                                                                           .cell = cell,
                                                                           .bucketKey = config.index.bucketKey,
                                                                           .index = config.index.follow,
                                                                           .surface = request.surface.kind,
                                                                           .localRadius = request.surface.localRadius,
                                                                           .widening = request.surface.widening,
                                                                           .friction = config.surface.friction,
                                                                           .tools = request.tools,
                                                                           .brush = request.brush,
                                                                           .threads = request.threads,
                                                                           .source = request.source,
                                                                           .extent = request.model.extent()});
  }

 private:
  std::unique_ptr<Simulator> simulator_ = cpuSimulator();
};

}  // namespace

std::unique_ptr<BackendKind> cpuBackend() { return std::make_unique<CpuBackend>(); }

}  // namespace palpate
