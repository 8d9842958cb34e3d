#include "apps/cli/matter_backend.hpp"

#include "engine/core/clock.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/matter/soft_model.hpp"
#include "haptics/session/backends.hpp"

namespace palpate {

std::vector<std::string> matterBackends() { return {"vulkan", "cpu"}; }

std::string chooseMatterBackend(const Context& context, const std::string& name, Matter matter) {
  if (name != "auto") return name;
  if (matter == Matter::soft) return "cpu";
  return context.hasRealGpu() ? "vulkan" : "cpu";
}

namespace {

// The scene's file is read, placed and filled.
std::shared_ptr<const SoftModel> softScan(Context& context, const MatterScene& scene, const MatterOptions& options) {
  planOf(scene, options.memory_bytes);  // before the file is read
  PointCloud cloud = readCloud(scene.model, &context.log(), {.pointsOnly = true}).cloud;
  const Stopwatch watch;
  auto model = softModelOf(scene, std::move(cloud), options.threads);
  context.log().say("{}: {} points are filled with {} nodes: {:.0f} ms", scene.model, model->points.size(),
                    model->solid.lattice.nodes(), watch.elapsed_us() * 1e-3);
  return model;
}

}  // namespace

std::unique_ptr<MatterSimulation> startMatter(Context& context, const std::string& backend, const MatterScene& scene,
                                              MatterOptions options) {
  options.threads = context.threads();
  if (!scene.model.empty()) options.soft = softScan(context, scene, options);
  return context.backends().named(backend).simulate(scene, options);
}

}  // namespace palpate
