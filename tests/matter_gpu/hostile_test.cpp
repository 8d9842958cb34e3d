// States that nobody wants to simulate, on the GPU.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate::hostile_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU no particle at all, and a single one, are simulated as well" * kFull) {
  checkFewParticles(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU thousands of particles on one place are a state with a name") {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const std::size_t count : {60, 1000, 5000}) {
      const MatterScene scene{.matter = matter};
      const auto world = onGpu(device)(scene, 0, std::vector<Vec3>(count, Vec3(0.05f)));
      for (int k = 0; k < 5; ++k) world->step();
      CHECK((world->state() == MatterState::crowded) == (count > 129));
      for (const Vec3& place : world->positionsById()) REQUIRE(isFinite(place));
    }
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a simulation that diverges says so, and can be begun again") {
  checkDivergence(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a hand that jumps gives a bounded force or ends the simulation") {
  checkJumpingHand(onGpu(device), 60);
}

TEST_SUITE_END();

}  // namespace palpate::hostile_test
