// Soft bodies whose points are felt on a GPU: as on the CPU.
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/touch/soft_scene.hpp"

namespace palpate {

namespace {

class SoftFixture : public GpuFixture {
 protected:
  SurfaceMaker onGpu() {
    return [this](const PointCloud& cloud, CloudSource& source, double radius, const SoftTouchOptions& touch) {
      return std::make_unique<TouchSide>(
          device, cloud,
          TouchOptions{.radius = radius, .friction = touch.friction, .tools = touch.tools, .source = &source});
    };
  }
  static SurfaceMaker onCpu() {
    return [](const PointCloud& cloud, CloudSource& source, double radius, const SoftTouchOptions& touch) {
      return std::make_unique<CpuTouch>(
          cloud,
          CpuTouchOptions{.radius = radius, .friction = touch.friction, .tools = touch.tools, .source = &source});
    };
  }
};

}  // namespace

TEST_CASE_FIXTURE(SoftFixture, "a soft body is felt on a GPU as on the CPU, and pressed as hard, by two hands") {
  MatterScene scene = softBlock();
  scene.fill_mm = {40, 30, 40};
  SoftTouching options;
  options.touch.tools.resize(2);
  options.touch.friction = 0.3;
  SoftScene gpu(scene, options, onGpu()), cpu(scene, options, onCpu());
  std::size_t touched = 0, disagreed = 0;
  for (int k = 0; k < 150; ++k) {
    const double time_s = 1e-3 * k, y = 31 - 5 * std::min(1.0, k / 100.0);
    const std::array poses{Pose{.time_s = time_s, .hip = {44 + 0.02 * k, y, 50}},
                           Pose{.time_s = time_s, .hip = {57, y + 1, 50}}};
    const auto a = gpu.touch().ask(poses, 0);
    const auto b = cpu.touch().ask(poses, 0);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(a[i].valid);
      CHECK(b[i].valid);
      touched += b[i].touching;
      disagreed += a[i].touching != b[i].touching;
      CHECK(glm::distance(a[i].proxy, b[i].proxy) < 0.02);
    }
    gpu.touch().prepare();
  }
  CHECK(touched > 150);
  CHECK(disagreed <= 4);
  const PointCloud there = gpu.points(), here = cpu.points();
  REQUIRE(there.size() == here.size());
  for (std::size_t i = 0; i < here.size(); ++i) CHECK(glm::distance(there.positions[i], here.positions[i]) < 0.02f);
  const DVec3 given = cpu.world().impulses().onTools;
  CHECK(glm::distance(gpu.world().impulses().onTools, given) < 0.01 * glm::length(given));
}

}  // namespace palpate
