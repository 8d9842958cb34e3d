// Balls between hands and matter on the GPU.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate::tool_test {

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a ball in water is pushed up by the weight of what it displaces" * kFull) {
  checkBuoyancy(onGpu(device), 0.03, 250, 150);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU what a ball got is what water lost" * kFull) {
  checkReactions(onGpu(device), 160);
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU random hands get no energy out of water and sand, with a gain of their forces, too" *
                      kFull) {
  for (const Matter matter : {Matter::water, Matter::sand}) checkRandomHands(onGpu(device), matter, 50, 1, 150);
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU the energy of a hand is that of the force that it gets, while the gain changes") {
  checkPortEnergy(onGpu(device), 90, 1e-4);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a ball that turns in viscous water is held back by it" * kFull) {
  checkTorque(onGpu(device), 150, 0.4, 0.7);
}

}  // namespace palpate::tool_test
