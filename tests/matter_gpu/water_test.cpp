// Water on the GPU: physical checks, and against the CPU after many steps.
#include <algorithm>

#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate::water_test {

namespace {

// Substeps of the last step that could rebuild lists.
std::int64_t listPasses(const GpuMatterWorld& world) {
  const std::vector<PassRecord> passes = world.passes();
  return std::ranges::count(passes, "matter_list", &PassRecord::name);
}

}  // namespace

TEST_CASE_FIXTURE(CoreGpuFixture, "thousands of particles have the same positions on the GPU as on the CPU") {
  const MatterScene still;
  const auto gpu = onGpu(device)(still, 0, placesAtRest(still)), cpu = onCpu()(still, 0, placesAtRest(still));
  run(*gpu, 10);
  run(*cpu, 10);
  CHECK(farthestApart(*gpu, *cpu) < 1e-6);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a dam break agrees with the CPU" * kFull) {
  const MatterScene dam = matterSceneNamed("dam");
  const auto gpuDam = onGpu(device)(dam, 0, placesAtRest(dam)), cpuDam = onCpu()(dam, 0, placesAtRest(dam));
  run(*gpuDam, 250);
  run(*cpuDam, 250);
  const MatterObservation is = gpuDam->observe(), expected = cpuDam->observe();
  CHECK(isWithin(0.02, is.front_m, expected.front_m));
  CHECK(isWithin(0.02, is.potential_J, expected.potential_J));
  CHECK(isWithin(0.03, is.kinetic_J, expected.kinetic_J));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU neighbour lists are rebuilt only when necessary") {
  const MatterScene scene = tank({8, 16, 8}, 12);
  GpuMatterWorld world(device, device.latencyQueue(), scene);
  run(world, 100);
  CHECK(world.listsMade() >= 1);
  CHECK(world.listsMade() < 15);
  CHECK(world.lateSubsteps() == 0);
  CHECK(listPasses(world) == 1);  // water at rest: even passes that return at once take time
  std::vector<Vec3> velocities(world.particles(), Vec3(0, 1, 0));
  world.setVelocities(velocities);
  const std::uint32_t before = world.listsMade();
  run(world, 1);
  CHECK(world.lateSubsteps() == 0);  // the velocities predicted it
  run(world, 29);                    // 30 mm up; lists allow 1 mm
  CHECK(world.lateSubsteps() <= 1);
  CHECK(world.listsMade() >= before + 10);
  CHECK(world.listsMade() < before + 30 * world.plan().substeps);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "neighbour lists are rebuilt in each substep once matter becomes fast") {
  MatterScene scene = tank({8, 16, 8}, 12);
  scene.tool = {.radius_mm = 20, .mass_kg = 0.05};
  GpuMatterWorld world(device, device.latencyQueue(), scene, {.tools = 1});
  HandPose hand{.place_m = {0.04, 0.16, 0.04}};
  const auto holdFor = [&](int steps) {
    for (int k = 0; k < steps; ++k) world.step({&hand, 1});
  };
  holdFor(40);
  CHECK(listPasses(world) == 1);
  for (int k = 0; k < 20; ++k) {  // 2 m/s, twice the displacement per step that lists allow
    hand.place_m.y -= 2e-3;
    world.step({&hand, 1});
    CHECK(listPasses(world) == world.plan().substeps);
  }
  CHECK(world.lateSubsteps() == 0);
  world.reset();
  hand.place_m.y = 0.16;
  holdFor(1);
  CHECK(listPasses(world) == world.plan().substeps);
  CHECK(world.state() == MatterState::running);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU the cohesion of water agrees with the CPU") {
  const MatterScene block = floatingBlock(0.0728);
  const auto gpu = onGpu(device)(block, 0, placesAtRest(block)), cpu = onCpu()(block, 0, placesAtRest(block));
  run(*gpu, 10);
  run(*cpu, 10);
  CHECK(farthestApart(*gpu, *cpu) < 1e-6);
}

}  // namespace palpate::water_test
