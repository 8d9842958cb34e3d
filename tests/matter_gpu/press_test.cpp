// Hands that press on soft bodies on the GPU: against what has to be.
#include "tests/labels.hpp"
#include "tests/matter/press_truths.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::press_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU what hands that press got is what the body lost") {
  checkPressMomentum(softOnGpu(device), 60);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU random hands that press get no energy out of a soft body" * kFull) {
  checkPressEnergy(softOnGpu(device), 250);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU presses of one hand are no more together than it bears") {
  checkMostOfHand(softOnGpu(device), 80);
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a surface gives way as a half-space, and as its mass where nothing holds it" * kFull) {
  checkCompliance(softOnGpu(device));
}

}  // namespace palpate::press_test
