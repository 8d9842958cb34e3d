// Creates matter on the GPU under test.
#pragma once

#include "engine/matter/gpu_matter_world.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/matter/matter_scenes.hpp"

namespace palpate {

inline MatterMaker onGpu(Device& device) {
  return [&device](const MatterScene& scene, std::size_t tools, std::vector<Vec3> places) {
    return std::make_unique<GpuMatterWorld>(device, device.latencyQueue(), scene, MatterOptions{.tools = tools},
                                            std::move(places));
  };
}

/// Maximum distance of a particle from its position in the other simulation, m.
inline double farthestApart(const MatterSimulation& a, const MatterSimulation& b) {
  const std::vector<Vec3> x = a.positionsById(), y = b.positionsById();
  REQUIRE(x.size() == y.size());
  double farthest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) farthest = std::max(farthest, double(glm::length(x[i] - y[i])));
  return farthest;
}

/// Tolerances between a simulation on a GPU and the same one on the CPU.
struct Alike {
  double places_m, kinetic, compression;  ///< kinetic energy: a share; compression: a difference of shares
  double leastForce_N, arm_m;    ///< scale of forces: expected force plus leastForce_N; of torques: times arm_m
  double energyShare, energy_J;  ///< of the hand's energy port
};

inline void checkAlike(const MatterSimulation& gpu, const MatterSimulation& cpu, const Alike& within) {
  const auto near = [](const DVec3& a, const DVec3& b, double scale) { return glm::length(a - b) <= 1e-3 * scale; };
  REQUIRE(gpu.state() == MatterState::running);
  REQUIRE(cpu.state() == MatterState::running);
  CHECK(farthestApart(gpu, cpu) < within.places_m);
  CHECK(isWithin(within.kinetic, gpu.totals().kinetic_J, cpu.totals().kinetic_J));
  CHECK(std::abs(gpu.totals().maxCompression - cpu.totals().maxCompression) < within.compression);
  const MatterImpulses &is = gpu.impulses(), &expected = cpu.impulses();
  const double given = glm::length(expected.gravity) + glm::length(expected.onWalls);
  CHECK(near(gpu.totals().momentum, cpu.totals().momentum, given));
  CHECK(near(is.gravity, expected.gravity, given));
  CHECK(near(is.onWalls, expected.onWalls, given));
  CHECK(near(is.onTools, expected.onTools, given));
  for (std::size_t tool = 0; tool < gpu.answers().size(); ++tool) {
    const ToolAnswer &answer = gpu.answers()[tool], &there = cpu.answers()[tool];
    const double force = glm::length(there.force_N) + within.leastForce_N;
    CHECK(near(answer.force_N, there.force_N, force));
    CHECK(near(answer.reaction_N, there.reaction_N, force));
    CHECK(near(answer.torque_Nm, there.torque_Nm, within.arm_m * force));
    CHECK(glm::length(answer.place_m - there.place_m) < 1e-7);
    CHECK(std::abs(gpu.portEnergy_J(tool) - cpu.portEnergy_J(tool)) <
          within.energyShare * std::abs(cpu.portEnergy_J(tool)) + within.energy_J);
  }
}

}  // namespace palpate
