// Numbers of a scene that change while it runs on the GPU.
#include "tests/matter_gpu/gpu_matter.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::parameters_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a simulation that is given a parameter goes on as one that has it") {
  checkParametersAreTaken(onGpu(device), 8);
  checkParametersKeepMotion(onGpu(device), 20);
  checkSoftParameters(softOnGpu(device), 40);
}

}  // namespace palpate::parameters_test
