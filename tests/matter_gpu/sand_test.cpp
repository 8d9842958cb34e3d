// Sand on the GPU: physical checks, and against the CPU.
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate::sand_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a column of sand collapses as far as on the CPU" * kMoreInFull) {
  const MatterScene scene = sandbox({400, 160, 80}, {80, 120, 80}, 0.4, 0);
  const auto gpu = onGpu(device)(scene, 0, placesAtRest(scene)), cpu = onCpu()(scene, 0, placesAtRest(scene));
  run(*gpu, 5);
  run(*cpu, 5);
  CHECK(farthestApart(*gpu, *cpu) < 1e-6);
  const int steps = byTier(20, 150);
  run(*gpu, steps);
  run(*cpu, steps);
  CHECK(isWithin(0.1, gpu->observe().front_m, cpu->observe().front_m));
  CHECK(isWithin(0.03, gpu->observe().potential_J, cpu->observe().potential_J));
}

}  // namespace palpate::sand_test
