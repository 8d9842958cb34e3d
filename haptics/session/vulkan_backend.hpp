#pragma once

#include <functional>
#include <memory>

#include "engine/select/cleaning.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/gpu_proofs.hpp"

namespace palpate {

class Device;

/// A GPU through Vulkan. `device` opens it when it is first needed, and may throw; the device must outlive everything
/// made on it. A session in real time is refused where `prove` names a wrong primitive.
std::unique_ptr<BackendKind> vulkanBackend(std::function<Device&()> device, ProveGpu prove);

/// Simulates scenes on that GPU; null if palpate was built without PALPATE_SIMULATION.
std::unique_ptr<Simulator> gpuSimulator(std::function<Device&()> device);

/// The grid of the index for a support radius (model units), as in the Vulkan back end.
HashGrid gridFor(const Model& model, const IndexConfig& config, double radius);

/// Estimates normals on that GPU; on the CPU if it is a software driver, which would take twice as long.
NormalEstimator estimateNormalsOn(std::function<Device&()> device);
/// What cleans a cloud: on the CPU, or, of so many points that opening a GPU is worth it, on a GPU, with the same
/// results but for the last digits of normals.
struct Cleaners {
  static constexpr std::size_t kFewestOnGpu = 1 << 20;
  NormalEstimator estimate = estimateNormalsOnCpu;
  DistanceMaker distances = nullptr;
};
/// `device` opens the GPU at the first use, on the thread that cleans, which alone uses it.
Cleaners cleanersOn(const std::function<Device&()>& device);

}  // namespace palpate
