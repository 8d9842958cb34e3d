// Strokes on the GPU produce the shape that the hand's motion defines, compared with analytic truth, and leave the far
// side of a plate unchanged; carving leaves nothing under it.
#include "engine/touch/touch_side.hpp"
#include "tests/clay.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

namespace palpate::gpu_clay_test {

TEST_CASE_FIXTURE(GpuFixture, "a drag on a GPU leaves a trench as deep as the hand, and no points above the surface" *
                                  kMoreInFull) {
  for (const char* shape : byTier<std::vector<const char*>>({"sphere"}, {"plane", "sphere"})) {
    const Scene scene = makeScene(shape, byTier(5'000, 20'000));
    for (const BrushKind kind : {BrushKind::push, BrushKind::carve})
      for (const double depth : byTier<std::vector<double>>({3}, {2, 3, 4, 6, 9, 18})) {
        CAPTURE(shape);
        CAPTURE(static_cast<int>(kind));
        CAPTURE(depth);
        TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = clayBrush(kind)});
        checkClay(mould(touch, scene, clayDrag(scene, depth, byTier(300.0, 100.0)), byTier(2, 1)), depth);
      }
  }
}

TEST_CASE_FIXTURE(GpuFixture, "on a GPU the far side of a plate stays unchanged, and the near side stops before it") {
  const Scene plate = makeClayPlate(4'000, 4);
  TouchSide touch(device, plate.cloud, {.radius = plate.radius, .brush = clayBrush(BrushKind::push)});
  CHECK(dragOverPlate(touch, plate, 4) < -1.5);
}

TEST_CASE_FIXTURE(GpuFixture, "a plate that is carved through on a GPU has no points below") {
  const Scene plate = makeClayPlate(4'000, 1);
  TouchSide touch(device, plate.cloud, {.radius = plate.radius, .brush = clayBrush(BrushKind::carve)});
  checkCarvingThroughPlate(touch, plate, 1);
}

}  // namespace palpate::gpu_clay_test
