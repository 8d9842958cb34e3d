// Balls between hands and matter on the GPU.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate::tool_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a ball in water has the buoyancy of the displaced water" * kFull) {
  checkBuoyancy(onGpu(device), 0.03, 250, 150);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a ball receives the momentum that the water loses" * kFull) {
  checkReactions(onGpu(device), 160);
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU random hands gain no energy from water and sand, even with a force gain" * kFull) {
  for (const Matter matter : {Matter::water, Matter::sand}) checkRandomHands(onGpu(device), matter, 50, 1, 150);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a hand's energy matches its force, also while the gain changes") {
  checkPortEnergy(onGpu(device), 90, 1e-4);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU viscous water resists the rotation of a ball" * kFull) {
  checkTorque(onGpu(device), 150, 0.4, 0.7);
}

}  // namespace palpate::tool_test
