// Extreme and invalid states, on the GPU.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate::hostile_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU no particle and a single particle are simulated" * kFull) {
  checkFewParticles(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU thousands of coincident particles give the state crowded, not a crash") {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const std::size_t count : {60, 1000, 5000}) {
      const MatterScene scene{.matter = matter};
      const auto world = onGpu(device)(scene, 0, std::vector<Vec3>(count, Vec3(0.05f)));
      for (int k = 0; k < 5; ++k) world->step();
      CHECK((world->state() == MatterState::crowded) == (count > 129));
      for (const Vec3& place : world->positionsById()) REQUIRE(isFinite(place));
    }
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a diverging simulation reports it and can be reset") {
  checkDivergence(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a hand that jumps gets a bounded force or ends the simulation") {
  checkJumpingHand(onGpu(device), 60);
}

TEST_SUITE_END();

}  // namespace palpate::hostile_test
