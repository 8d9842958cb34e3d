#include "apps/simulation/matter_backend.hpp"

#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/gpu/device.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/matter/gpu_soft_world.hpp"
#include "engine/matter/soft_model.hpp"
#include "engine/matter/soft_world.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/simulation/scene_model.hpp"
#include "haptics/simulation/simulator.hpp"

namespace palpate {

std::vector<std::string> matterBackends() { return {"vulkan", "cpu"}; }

std::string chooseMatterBackend(const Context& context, const std::string& name) {
  if (name != "auto") return name;
  return context.hasRealGpu() ? "vulkan" : "cpu";
}

namespace {

// A soft body from the scene's shape, or from its file, which is read, placed and filled.
std::unique_ptr<MatterSimulation> softBody(Context& context, const std::string& backend, const MatterScene& scene,
                                           const MatterOptions& options) {
  if (scene.model.empty()) {
    const auto model = softModelFor(scene, options);
    return startSoft(context, backend, scene, options, model->solid, model->points);
  }
  PointCloud cloud = readCloud(scene.model, &context.log(), {.pointsOnly = true}).cloud;
  const Stopwatch watch;
  const auto model = softModelOf(scene, std::move(cloud), options.threads);
  context.log().say("{}: a body of {}, filled with {} in {:.0f} ms", scene.model,
                    counted(model->points.size(), "point"), counted(model->solid.lattice.nodes(), "node"),
                    watch.elapsed_us() * 1e-3);
  return startSoft(context, backend, scene, options, model->solid, model->points);
}

}  // namespace

std::unique_ptr<MatterSimulation> startSoft(Context& context, const std::string& backend, const MatterScene& scene,
                                            const MatterOptions& options, SoftSolid solid,
                                            std::span<const SurfacePlace> points) {
  if (backend == "cpu") return std::make_unique<SoftWorld>(scene, options, std::move(solid), points);
  Device& device = context.device();
  return std::make_unique<GpuSoftWorld>(device, device.latencyQueue(), scene, options, solid, points);
}

std::unique_ptr<MatterSimulation> startMatter(Context& context, const std::string& backend, const MatterScene& scene,
                                              MatterOptions options) {
  options.threads = context.threads();
  options.memory_bytes = simulatorOf(context.backends().named(backend)).memory_bytes();
  planOf(scene, options.memory_bytes);  // before a file is read
  if (scene.matter != Matter::soft) {
    options.model = standingModel(scene, {.log = context.log(), .threads = options.threads});
    return simulatorOf(context.backends().named(backend)).simulate(scene, options);
  }
  return softBody(context, backend, scene, options);
}

}  // namespace palpate
