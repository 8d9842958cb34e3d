#include "haptics/library/gpu_half.hpp"

#include <optional>

#include "engine/gpu/device_lookup.hpp"
#include "engine/mesh/marching_cubes.hpp"
#include "engine/mesh/mesh_memory.hpp"
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

struct GpuHalf::State {
  std::string gpu;
  std::unique_ptr<Device> device;
  std::optional<SessionPicture> picture;

  Device& opened() {
    if (!device) device = std::make_unique<Device>(DeviceOptions{.gpu = gpu});
    return *device;
  }
};

GpuHalf::GpuHalf(std::string gpu) : state_(std::make_unique<State>()) { state_->gpu = std::move(gpu); }

GpuHalf::~GpuHalf() {
  if (state_->device) state_->device->waitIdle();
}

std::unique_ptr<BackendKind> GpuHalf::backend() {
  return vulkanBackend([this]() -> Device& { return state_->opened(); });
}

void GpuHalf::follow(const EditBatch& batch) noexcept {
  try {
    if (state_->picture) state_->picture->follow(batch);
  } catch (...) {
    state_->picture.reset();  // the next one copies all points again
  }
}

void GpuHalf::forgetPicture() { state_->picture.reset(); }

Image GpuHalf::draw(const Model& model, const Journal* journal, const PictureRequest& request) {
  if (!state_->picture) state_->picture.emplace(state_->opened());
  return state_->picture->draw(model, journal, request);
}

Mesh GpuHalf::mesh(const PointCloud& cloud, const MeshPlan& plan) {
  Device& device = state_->opened();
  requireMeshMemory(device, predictMeshMemory(cloud, plan));
  MarchingCubes cubes(device, cloud, plan);
  cubes.build();
  return cubes.download();
}

}  // namespace palpate::library
