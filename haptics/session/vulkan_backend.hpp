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
/// Of so many points that opening the GPU, which happens at the first call, is worth it.
DistanceMaker neighbourDistancesOn(std::function<Device&()> device);

}  // namespace palpate
