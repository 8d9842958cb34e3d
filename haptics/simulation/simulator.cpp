#include "haptics/simulation/simulator.hpp"

#include "engine/core/processor.hpp"
#include "engine/matter/matter_world.hpp"
#include "engine/matter/soft_world.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

class CpuSimulator final : public MatterSimulator {
 public:
  std::uint64_t memory_bytes() const override { return matterMemory(hostMemory_bytes()); }
  std::unique_ptr<MatterSimulation> simulate(const MatterScene& scene, const MatterOptions& options) const override {
    if (scene.matter == Matter::soft) return std::make_unique<SoftWorld>(scene, options);
    return std::make_unique<MatterWorld>(scene, options);
  }
};

}  // namespace

std::unique_ptr<Simulator> cpuSimulator() { return std::make_unique<CpuSimulator>(); }

const MatterSimulator& simulatorOf(const BackendKind& backend) {
  // All simulators are made here and in gpu_simulator.cpp.
  if (const Simulator* const simulator = backend.simulator()) return static_cast<const MatterSimulator&>(*simulator);
  throw ConfigError("backend.name", "{} cannot simulate matter; use vulkan or cpu", backend.name());
}

}  // namespace palpate
