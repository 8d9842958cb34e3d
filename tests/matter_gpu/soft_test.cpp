// Soft bodies on the GPU: physical checks.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::soft_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a bar hangs, bends and vibrates as theory predicts") {
  checkHangingBar(softOnGpu(device), {10, 2, 2}, 0.3);
  checkCantilever(softOnGpu(device), {8, 1, 1});
  checkStretchFrequency(softOnGpu(device), {10, 1, 1}, 2);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a ball pressed by a hand pushes back as Hertz predicts" * kFull) {
  checkHertz(softOnGpu(device), {.width = 16, .height = 12, .ball = 5, .poisson = 0.45, .within = 0.09});
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a rotation causes no stress") {
  checkTurned(softOnGpu(device), bendOnGpu());
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU the momentum of a soft body balances gravity, walls, pins and tools" * kMoreInFull) {
  checkSoftMomentum(softOnGpu(device), byTier(30, 120));
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a ball receives the momentum that the soft body loses, and the hand feels it" * kFull) {
  checkSoftReactions(softOnGpu(device), 200, 250);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a soft body that is pushed and released returns to its shape" * kFull) {
  checkReturn(softOnGpu(device), 150, 850);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU random hands gain no energy from a soft body" * kFull) {
  checkSoftPortEnergy(softOnGpu(device), 2, 400);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU pinned nodes stay at rest") { checkPinsHold(softOnGpu(device), 10); }

TEST_CASE_FIXTURE(CoreGpuFixture, "soft bodies on the same GPU give the same results bit by bit" * kMoreInFull) {
  checkSameSoftBytes(softOnGpu(device), softOnGpu(device), byTier(15, 60));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a diverging soft body reports it and can be reset") {
  checkSoftDivergence(softOnGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a hand that jumps onto a soft body gets a bounded force or ends the simulation") {
  checkSoftJump(softOnGpu(device), 60);
}

}  // namespace palpate::soft_test
