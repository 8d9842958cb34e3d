// Hands that press on soft bodies on the GPU: physical checks.
#include "tests/labels.hpp"
#include "tests/matter/press_truths.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::press_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU pressing hands receive the momentum that the body loses") {
  checkPressMomentum(softOnGpu(device), 60);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU random pressing hands gain no energy from a soft body" * kFull) {
  checkPressEnergy(softOnGpu(device), 250);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU the presses of one hand together stay below the hand's maximum force") {
  checkMostOfHand(softOnGpu(device), 80);
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a surface yields like a half-space, and like its mass if nothing holds it" * kFull) {
  checkCompliance(softOnGpu(device));
}

}  // namespace palpate::press_test
