// Scene parameters that change during a simulation on the GPU.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::parameters_test {

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a simulation with a changed parameter continues like one that started with it" *
                      kMoreInFull) {
  checkParametersAreTaken(onGpu(device), byTier(3, 8));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a parameter change alone moves nothing" * kMoreInFull) {
  checkParametersKeepMotion(onGpu(device), byTier(8, 20));
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a soft body with a changed parameter continues like one that started with it" *
                      kMoreInFull) {
  checkSoftParameters(softOnGpu(device), byTier(12, 40));
}

}  // namespace palpate::parameters_test
