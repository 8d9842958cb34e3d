// Creates soft bodies on the GPU under test.
#pragma once

#include "engine/matter/gpu_soft_world.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/matter/soft_maker.hpp"

namespace palpate {

inline SoftMaker softOnGpu(Device& device) {
  return [&device](const MatterScene& scene, std::size_t tools, const SoftSolid* solid,
                   std::span<const SurfacePlace> points) -> std::unique_ptr<MatterSimulation> {
    const MatterOptions options{.tools = tools};
    if (solid == nullptr) return std::make_unique<GpuSoftWorld>(device, device.latencyQueue(), scene, options);
    return std::make_unique<GpuSoftWorld>(device, device.latencyQueue(), scene, options, *solid, points);
  };
}

inline SoftBend bendOnGpu() {
  return [](MatterSimulation& world, std::span<const Vec3> displacements) {
    dynamic_cast<GpuSoftWorld&>(world).setDisplacements(displacements);
  };
}

}  // namespace palpate
