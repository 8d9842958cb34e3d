// Strokes on the GPU leave what the hand meant, by analytic truth, and the far side of a plate as it was.
#include "engine/touch/touch_side.hpp"
#include "tests/clay.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

namespace palpate::gpu_clay_test {

TEST_CASE_FIXTURE(GpuFixture,
                  "a drag on a GPU leaves a trench as deep as the hand, and nothing over the surface" * kMoreInFull) {
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

TEST_CASE_FIXTURE(GpuFixture, "on a GPU the far side of a plate stays as it is, and the near one stops before it") {
  Scene scene = makeScene("plane", 4'000);
  const std::size_t near = scene.cloud.size();
  for (std::size_t i = 0; i < near; ++i) {
    scene.cloud.positions.push_back(scene.cloud.positions[i] - Vec3(0, 0, 4));
    scene.cloud.normals.push_back(-scene.cloud.normals[i]);
  }
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = clayBrush(BrushKind::push)});
  const ClayGesture gesture = clayDrag(scene, 5.5, 300);
  for (std::size_t k = 0; k + 110 < gesture.hips.size(); ++k)
    touch.query({.time_s = 1e-3 * static_cast<double>(k), .hip = gesture.hips[k]}, 0);
  touch.finish();
  PointCloud after = scene.cloud;
  CHECK(touch.readBack(after) > 20);
  std::size_t far = 0;
  double lowest = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after.normals[i].z < -0.5f) {
      ++far;
      CHECK(after.positions[i].z == -4);
    } else {
      lowest = std::min(lowest, static_cast<double>(after.positions[i].z));
    }
  }
  CHECK(far == near);
  CHECK(lowest > -4);
  CHECK(lowest < -1.5);
}

}  // namespace palpate::gpu_clay_test
