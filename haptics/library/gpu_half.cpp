#include "haptics/library/gpu_half.hpp"

#include <optional>

#include "engine/gpu/device_lookup.hpp"
#include "engine/gpu/host_device.hpp"
#include "engine/mesh/marching_cubes.hpp"
#include "engine/mesh/mesh_memory.hpp"
#include "engine/proof/gpu_proof.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/picture.hpp"
#include "haptics/session/vulkan_backend.hpp"

namespace palpate::library {

std::vector<std::string> gpuNames() {
  std::vector<std::string> names;
  for (const GpuDescription& gpu : gpusHere()) names.push_back(gpu.name);
  return names;
}

bool hasRealGpu() { return palpate::hasRealGpu({}); }

void writePicture(const std::string& file, const Image& image) { writeImage(file, image); }

namespace {

HostQueue queueFrom(const pp_vulkan_queue& queue) { return {static_cast<VkQueue>(queue.handle), queue.family}; }

HostDevice hostFrom(const pp_vulkan_device& device) {
  HostDevice host{.getInstanceProcAddr = reinterpret_cast<PFN_vkGetInstanceProcAddr>(device.get_instance_proc_addr),
                  .instance = static_cast<VkInstance>(device.instance),
                  .apiVersion = device.api_version,
                  .validation = device.validated ? Validation::core : Validation::off,
                  .debugUtils = device.debug_utils != 0,
                  .physical = static_cast<VkPhysicalDevice>(device.physical_device),
                  .device = static_cast<VkDevice>(device.device),
                  .features = static_cast<const VkPhysicalDeviceFeatures2*>(device.features),
                  .throughput = queueFrom(device.throughput),
                  .latency = queueFrom(device.latency),
                  .background = queueFrom(device.background)};
  void* const user = device.lock_user;
  if (device.lock) host.lock = [lock = device.lock, user](VkQueue queue) { lock(user, queue); };
  if (device.unlock) host.unlock = [unlock = device.unlock, user](VkQueue queue) { unlock(user, queue); };
  return host;
}

}  // namespace

struct GpuHalf::State {
  std::string gpu;
  bool lent = false;
  std::unique_ptr<Device> device;
  std::optional<SessionPicture> picture;

  Device& opened() {
    if (!device) device = openProven({.gpu = gpu});
    return *device;
  }
};

GpuHalf::GpuHalf(const GpuChoice& choice) : state_(std::make_unique<State>()) {
  const bool names = choice.gpu && std::string("cpu") != choice.gpu;
  if (!choice.lent) {
    if (names) state_->gpu = choice.gpu;
    return;
  }
  if (names) throw UsageError("gpu: '{}' is named, and a device is lent in vulkan; leave one of them out", choice.gpu);
  state_->lent = true;
  state_->device = std::make_unique<Device>(hostFrom(optionsFrom(choice.lent, "vulkan")));
}

GpuHalf::~GpuHalf() {
  if (state_->device) state_->device->waitIdle();
}

std::unique_ptr<BackendKind> GpuHalf::backend() {
  return vulkanBackend([this]() -> Device& { return state_->opened(); },
                       [this](Device& device) {
                         const auto quietly = [](std::string_view) {};
                         return wrongOn(device, GpuProofs(), quietly, [&] {
                           return state_->lent ? proveGpu(device).wrong()
                                               : proveSizes(device, {.gpu = state_->gpu}).front().wrong();
                         });
                       });
}

void GpuHalf::follow(const EditBatch& batch) noexcept {
  try {
    if (state_->picture) state_->picture->follow(batch);
  } catch (...) {
    state_->picture.reset();  // the next picture copies all points again
  }
}

void GpuHalf::forgetPicture() { state_->picture.reset(); }

Image GpuHalf::draw(const Layer& layer, const History* history, const PictureRequest& request) {
  if (!state_->picture) state_->picture.emplace(state_->opened());
  return state_->picture->draw(layer, history, request);
}

Mesh GpuHalf::mesh(const PointCloud& cloud, const MeshPlan& plan) {
  Device& device = state_->opened();
  requireMeshMemory(device, predictMeshMemory(cloud, plan));
  MarchingCubes cubes(device, cloud, plan);
  cubes.build();
  return cubes.download();
}

}  // namespace palpate::library
