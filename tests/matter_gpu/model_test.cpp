// Models standing in matter on the GPU, and balls that start there.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate::model_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "a model in water and sand has the same effect on the GPU as on the CPU") {
  for (const Matter matter : {Matter::water, Matter::sand}) {
    CAPTURE(static_cast<int>(matter));
    MatterScene scene = modelInTank("sphere", 60, matter);
    scene.gravity_m_s2 = {3, -7, 5};
    scene.tool = {.radius_mm = 15, .mass_kg = 0.03};
    const auto gpu = atRest(onGpu(device), scene, 1), cpu = atRest(onCpu(), scene, 1);
    REQUIRE(gpu->leftOut() == cpu->leftOut());
    REQUIRE(gpu->leftOut() > 50);
    const HandPose hand{.place_m = {0.07, 0.16, 0.07}};
    for (int k = 0; k < 8; ++k) {
      gpu->step({&hand, 1});
      cpu->step({&hand, 1});
    }
    REQUIRE(gpu->state() == MatterState::running);
    CHECK(farthestApart(*gpu, *cpu) < 1e-6);
    const double given = glm::length(cpu->impulses().onModel);
    CHECK(given > 1e-5);
    CHECK(glm::length(gpu->impulses().onModel - cpu->impulses().onModel) < 2e-3 * given);
    const double force = glm::length(cpu->onModel().force_N) + 0.01;
    CHECK(glm::length(gpu->onModel().force_N - cpu->onModel().force_N) < 5e-3 * force);
    CHECK(glm::length(gpu->onModel().torque_Nm - cpu->onModel().torque_Nm) < 5e-3 * 0.03 * force);
    CHECK(missingMomentum(*gpu) <= 1e-5);
    gpu->reset();
    CHECK(gpu->impulses().onModel == DVec3(0));
  }
}

TEST_CASE_FIXTURE(CoreGpuFixture, "a ball that starts in water grows there, on the GPU as on the CPU" * kMoreInFull) {
  MatterScene scene = tank({12, 14, 12}, 10);
  scene.tool = {.radius_mm = 20, .mass_kg = 0.03};
  const HandPose hand{.place_m = {0.055, 0.055, 0.065}};
  const auto gpu = atRest(onGpu(device), scene, 1), cpu = atRest(onCpu(), scene, 1);
  for (int k = 0; k < 12; ++k) {
    gpu->step({&hand, 1});
    cpu->step({&hand, 1});
  }
  CHECK(gpu->pushedOut(0) == cpu->pushedOut(0));
  CHECK(farthestApart(*gpu, *cpu) < 2e-6);
  CHECK(missingMomentum(*gpu) <= 1e-5);
  if (!inFullTier()) return;
  for (int k = 0; k < 280; ++k) gpu->step({&hand, 1});
  REQUIRE(gpu->state() == MatterState::running);
  CHECK(withinBall(*gpu, gpu->answers()[0].place_m, 0.02) == 0);
  CHECK(missingMomentum(*gpu) <= 1e-5);
}

}  // namespace palpate::model_test
