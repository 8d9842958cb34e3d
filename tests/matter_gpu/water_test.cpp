// Water on the GPU: against what water has to be, and against the CPU after many steps.
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate {

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU water at rest presses and weighs as it does on the CPU") {
  checkWaterAtRest(onGpu(device), 200, 80);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU momentum is what gravity gave less what the walls took") {
  checkMomentumIsAccountedFor(onGpu(device), 150);
  checkMomentumStays(onGpu(device), 30);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU no particle is ever beyond a wall") {
  checkWallsHold(onGpu(device), 100);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "the same GPU gives the same bytes every time") {
  for (const Matter matter : {Matter::water, Matter::sand}) checkSameBytes(onGpu(device), onGpu(device), matter, 60);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "thousands of particles are where they are on the CPU, and a dam breaks as there") {
  const MatterScene still;
  const auto gpu = onGpu(device)(still, 0, placesAtRest(still)), cpu = onCpu()(still, 0, placesAtRest(still));
  run(*gpu, 10);
  run(*cpu, 10);
  CHECK(farthestApart(*gpu, *cpu) < 1e-6);
  const MatterScene dam = matterSceneNamed("dam");
  const auto gpuDam = onGpu(device)(dam, 0, placesAtRest(dam)), cpuDam = onCpu()(dam, 0, placesAtRest(dam));
  run(*gpuDam, 250);
  run(*cpuDam, 250);
  const MatterObservation is = gpuDam->observe(), expected = cpuDam->observe();
  CHECK(isWithin(0.02, is.front_m, expected.front_m));
  CHECK(isWithin(0.02, is.potential_J, expected.potential_J));
  CHECK(isWithin(0.03, is.kinetic_J, expected.kinetic_J));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU lists are made when they have to be, and not more often") {
  const MatterScene scene = tank({8, 16, 8}, 12);
  GpuMatterWorld world(device, device.latencyQueue(), scene);
  run(world, 100);
  CHECK(world.listsMade() >= 1);
  CHECK(world.listsMade() < 10);
  std::vector<Vec3> velocities(world.particles(), Vec3(0, 1, 0));
  world.setVelocities(velocities);
  const std::uint32_t before = world.listsMade();
  run(world, 30);  // 30 mm up, of which lists allow 1.5
  CHECK(world.listsMade() >= before + 10);
  CHECK(world.listsMade() < before + 30 * world.plan().substeps);
}

}  // namespace palpate
