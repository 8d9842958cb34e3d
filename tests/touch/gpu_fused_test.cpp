// Depth frames that fuse while they are felt, on the GPU.
#include "engine/motion/fused_source.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/touch/fused_scene.hpp"

namespace palpate {

TEST_CASE_FIXTURE(GpuFixture, "depth frames are felt while they fuse on the GPU, and what is taken away is felt no more") {
  checkFusedTouch([this](TableStream& stream, const PointCloud& cloud, double radius) {
    return FusedTouch{.backend = std::make_unique<TouchSide>(
                          device, cloud,
                          TouchOptions{.radius = radius,
                                       .fusion = FusedStream{.stream = &stream, .options = smallMap(60'000)}}),
                      .source = nullptr};
  });
}

TEST_CASE_FIXTURE(GpuFixture, "a map that is fused on the host is felt on the GPU as it is on the host") {
  TableStream first, second;
  const PointCloud cloud = first.firstCloud();
  FusedSource source(unowned(first), smallMap(60'000));
  const double radius = 4 * meanSpacing(cloud);
  TouchSide host(device, cloud, {.radius = radius, .source = &source});
  TouchSide fused(device, cloud, {.radius = radius, .fusion = FusedStream{.stream = &second, .options = smallMap(60'000)}});
  for (int i = 0; i < 300; i += 3) {
    const Pose pose{.time_s = 1e-3 * i, .hip = {0.002 * std::sin(0.05 * i), 0, std::max(0.09 - 0.0005 * i, 0.079)}};
    const Contact a = host.query(pose, 0), b = fused.query(pose, 0);
    CHECK(a.touching == b.touching);
    CHECK(glm::distance(a.proxy, b.proxy) < 1e-5);
  }
}

}  // namespace palpate
