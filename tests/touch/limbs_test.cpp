// Strokes beside other limbs on the CPU. Needs no GPU.
#include "tests/touch/limbs.hpp"
#include "engine/touch/cpu_touch.hpp"

namespace palpate::limbs_test {

namespace {

std::unique_ptr<TouchBackend> onCpu(const PointCloud& cloud, double radius, const BrushOptions& brush) {
  return std::make_unique<CpuTouch>(cloud, CpuTouchOptions{.radius = radius, .brush = brush, .threads = 1});
}

}  // namespace

TEST_CASE("a press on a limb leaves the limb beside it unchanged, at any gap, and is as deep as alone") {
  checkRods(onCpu);
}
TEST_CASE("every brush but carve leaves the limb beside the touched one unchanged") { checkOtherBrushes(onCpu); }
TEST_CASE("a press leaves a limb that crosses over the pressed one unchanged") { checkCrossing(onCpu); }
TEST_CASE("a press on a plate leaves a plate below it unchanged") { checkPlates(onCpu); }
TEST_CASE("a press on an edge moves both of its faces") { checkEdge(onCpu); }
TEST_CASE("a push along a wall leaves no hole in the floor beside it") { checkCorner(onCpu); }
TEST_CASE("an edge is dragged with the side that is held under it, without holes") { checkHeldEdge(onCpu); }
TEST_CASE("a press into the crease of two limbs that have grown together moves both") { checkMerged(onCpu); }
TEST_CASE("repeated presses widen and deepen a dent: its walls belong to the stroke") { checkOwnDent(onCpu); }
TEST_CASE("a press that is dragged from one limb to the next moves both") { checkDragOver(onCpu); }

}  // namespace palpate::limbs_test
