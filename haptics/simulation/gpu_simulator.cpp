#include "engine/gpu/device.hpp"
#include "engine/matter/gpu_matter_world.hpp"
#include "engine/matter/gpu_soft_world.hpp"
#include "haptics/session/vulkan_backend.hpp"
#include "haptics/simulation/simulator.hpp"

namespace palpate {

namespace {

class GpuSimulator final : public MatterSimulator {
 public:
  explicit GpuSimulator(std::function<Device&()> device) : device_(std::move(device)) {}

  std::uint64_t memory_bytes() const override { return matterMemory(device_().ownMemory()); }
  std::unique_ptr<MatterSimulation> simulate(const MatterScene& scene, const MatterOptions& options) const override {
    // On a queue of its own, beside the queries of the surface of its points.
    if (scene.matter == Matter::soft)
      return std::make_unique<GpuSoftWorld>(device_(), device_().backgroundQueue().another(), scene, options);
    return std::make_unique<GpuMatterWorld>(device_(), device_().latencyQueue(), scene, options);
  }

 private:
  std::function<Device&()> device_;
};

}  // namespace

std::unique_ptr<Simulator> gpuSimulator(std::function<Device&()> device) {
  return std::make_unique<GpuSimulator>(std::move(device));
}

}  // namespace palpate
