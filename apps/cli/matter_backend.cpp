#include "apps/cli/matter_backend.hpp"

#include <algorithm>

#include "engine/matter/gpu_matter_world.hpp"
#include "engine/matter/matter_world.hpp"

namespace palpate {

std::vector<std::string> matterBackends() { return {"vulkan", "cpu"}; }

std::string chooseMatterBackend(const Context& context, const std::string& name) {
  if (name != "auto") return name;
  return context.hasRealGpu() ? "vulkan" : "cpu";
}

std::uint64_t matterMemory(Context& context, const std::string& backend) {
  return backend == "cpu" ? kMostMatterBytes : std::max(kMostMatterBytes, context.device().ownMemory() / 2);
}

std::unique_ptr<MatterSimulation> startMatter(Context& context, const std::string& backend, const MatterScene& scene,
                                              MatterOptions options) {
  options.threads = context.threads();
  options.memory_bytes = matterMemory(context, backend);
  if (backend == "cpu") return std::make_unique<MatterWorld>(scene, options);
  return std::make_unique<GpuMatterWorld>(context.device(), context.device().latencyQueue(), scene, options);
}

}  // namespace palpate
