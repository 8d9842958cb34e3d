// Soft bodies on the GPU: against what they have to be.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::soft_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a bar hangs and bends by its own weight, and swings, as it should") {
  checkHangingBar(softOnGpu(device), {10, 2, 2}, 0.3);
  checkCantilever(softOnGpu(device), {8, 1, 1});
  checkStretchFrequency(softOnGpu(device), {10, 1, 1}, 2);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a ball in a hand is pushed back as Hertz says" * kFull) {
  checkHertz(softOnGpu(device), {.width = 16, .height = 12, .ball = 5, .poisson = 0.45, .within = 0.09});
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a turn makes no stress") { checkTurned(softOnGpu(device), bendOnGpu()); }

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU momentum is what gravity gave less what walls, pins and tools took" * kMoreInFull) {
  checkSoftMomentum(softOnGpu(device), byTier(30, 120));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU what a ball got is what the body lost, and the hand feels that" * kFull) {
  checkSoftReactions(softOnGpu(device), 200, 250);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU what is pushed and let go returns to where it was" * kFull) {
  checkReturn(softOnGpu(device), 150, 850);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU random hands get no energy out of a soft body" * kFull) {
  checkSoftPortEnergy(softOnGpu(device), 2, 400);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU what is pinned stays, and has no velocity") {
  checkPinsHold(softOnGpu(device), 10);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "the same GPU gives a soft body the same bytes every time" * kMoreInFull) {
  checkSameSoftBytes(softOnGpu(device), softOnGpu(device), byTier(15, 60));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a soft body that diverges says so, and can be begun again") {
  checkSoftDivergence(softOnGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a hand that jumps onto a soft body gives a bounded force or ends it") {
  checkSoftJump(softOnGpu(device), 60);
}

}  // namespace palpate::soft_test
