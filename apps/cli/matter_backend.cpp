#include "apps/cli/matter_backend.hpp"

#include "haptics/session/backends.hpp"

namespace palpate {

std::vector<std::string> matterBackends() { return {"vulkan", "cpu"}; }

std::string chooseMatterBackend(const Context& context, const std::string& name) {
  if (name != "auto") return name;
  return context.hasRealGpu() ? "vulkan" : "cpu";
}

std::unique_ptr<MatterSimulation> startMatter(Context& context, const std::string& backend, const MatterScene& scene,
                                              MatterOptions options) {
  options.threads = context.threads();
  return context.backends().named(backend).simulate(scene, options);
}

}  // namespace palpate
