// Numbers of a scene that change while it runs on the GPU.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::parameters_test {

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a simulation that is given a parameter goes on as one that has it" * kMoreInFull) {
  checkParametersAreTaken(onGpu(device), byTier(3, 8));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a parameter that changes moves nothing by itself" * kMoreInFull) {
  checkParametersKeepMotion(onGpu(device), byTier(8, 20));
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a soft body that is given a parameter goes on as one that has it" * kMoreInFull) {
  checkSoftParameters(softOnGpu(device), byTier(12, 40));
}

}  // namespace palpate::parameters_test
