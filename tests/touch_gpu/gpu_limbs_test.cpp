// Strokes beside other limbs on the GPU.
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/touch/limbs.hpp"

namespace palpate::gpu_limbs_test {

namespace {

MakeLimbTouch onGpu(Device& device) {
  return [&device](const PointCloud& cloud, double radius, const BrushOptions& brush) {
    return std::make_unique<TouchSide>(device, cloud, TouchOptions{.radius = radius, .brush = brush});
  };
}

}  // namespace

TEST_CASE_FIXTURE(
    CoreGpuFixture,
    "on the GPU a press on a limb leaves the limb beside it unchanged, at any gap, and is as deep as alone") {
  checkRods(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU every brush but carve leaves the limb beside the touched one unchanged") {
  checkOtherBrushes(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a press leaves a limb that crosses over the pressed one unchanged") {
  checkCrossing(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a press on a plate leaves a plate below it unchanged") {
  checkPlates(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a press on an edge moves both of its faces") { checkEdge(onGpu(device)); }

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a push along a wall leaves no hole in the floor beside it") {
  checkCorner(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU an edge is dragged with the side that is held under it, without holes") {
  checkHeldEdge(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU a press into the crease of two limbs that have grown together moves both") {
  checkMerged(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "on the GPU repeated presses widen and deepen a dent: its walls belong to the stroke") {
  checkOwnDent(onGpu(device));
}

TEST_CASE_FIXTURE(CoreGpuFixture, "on the GPU a press that is dragged from one limb to the next moves both") {
  checkDragOver(onGpu(device));
}

}  // namespace palpate::gpu_limbs_test
