// A few hundred particles on the GPU against the same ones on the CPU.
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate {

TEST_CASE_FIXTURE(GpuFixture, "water on the GPU is where it is on the CPU") {
  const MatterScene scene = tank({6, 12, 6}, 8);
  const auto gpu = onGpu(device)(scene, 0, placesAtRest(scene));
  const auto cpu = onCpu()(scene, 0, placesAtRest(scene));
  for (int k = 0; k < 4; ++k) {
    run(*gpu, 1);
    run(*cpu, 1);
    CHECK(farthestApart(*gpu, *cpu) < 1e-6);
  }
}

}  // namespace palpate
