// Matter on the GPU that is tested.
#pragma once

#include "engine/matter/gpu_matter_world.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/matter/matter_truths.hpp"

namespace palpate {

inline MatterMaker onGpu(Device& device) {
  return [&device](const MatterScene& scene, std::size_t tools, std::vector<Vec3> places) {
    return std::make_unique<GpuMatterWorld>(device, device.latencyQueue(), scene, MatterOptions{.tools = tools},
                                            std::move(places));
  };
}

/// Farthest that a particle is from where it is in the other simulation, m.
inline double farthestApart(const MatterSimulation& a, const MatterSimulation& b) {
  const std::vector<Vec3> x = a.positionsById(), y = b.positionsById();
  REQUIRE(x.size() == y.size());
  double farthest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) farthest = std::max(farthest, double(glm::length(x[i] - y[i])));
  return farthest;
}

}  // namespace palpate
