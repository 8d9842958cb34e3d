// Clouds that move, on the GPU; tests/touch/moving_test.cpp has the cases of each back end.
#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/touch/moving_scene.hpp"

namespace palpate::gpu_moving_test {

namespace {

/// All points gather in one position for a while: far more than a bucket usually holds.
class CrowdingSource final : public CloudSource {
 public:
  explicit CrowdingSource(const PointCloud& cloud) : rest_(cloud) {}
  std::size_t size() const override { return rest_.size(); }
  void makeFrame(double time_s, CloudFrame& frame) override {
    const float share = time_s > 2.5 * kTick_s && time_s < 5.5 * kTick_s ? 1e-6f : 1.0f;
    frame = {.time_s = time_s, .positions = rest_.positions, .normals = rest_.normals};
    for (Vec3& position : frame.positions) position *= share;
  }

 private:
  const PointCloud& rest_;
};

}  // namespace

TEST_CASE_FIXTURE(GpuFixture,
                  "a source at rest gives the same answers as no source, bit by bit, for each query and sort method") {
  const Scene scene = makeScene("torus", 2'000, DVec3(100, 7, -3));
  MovingCloud source(scene.cloud, {.kind = MotionKind::turn, .centre = {3, 2, 1}});
  for (const auto& [name, method] : builtMethods())
    for (const SortMethod sort : {SortMethod::counting, SortMethod::radix}) {
      const TouchOptions options{.radius = scene.radius, .sort = sort, .method = method};
      TouchOptions moved = options;
      moved.source = &source;
      TouchSide moving(device, scene.cloud, moved), alone(device, scene.cloud, options);
      std::size_t touched = 0, other = 0;
      double time_s = 0;
      for (const DVec3& hip : wanderingPath(scene, 50, 0.5 * scene.radius, 3)) {
        const Pose pose{.time_s = time_s += kTick_s, .hip = hip};
        const Contact a = moving.query(pose, 0), b = alone.query(pose, 0);
        touched += a.touching;
        other += !sameAnswer(a, b);
      }
      CHECK(touched > 5);
      CHECK(other == 0);
    }
}

TEST_CASE_FIXTURE(GpuFixture, "both back ends agree on a rotating cloud, and end with the source's points") {
  const Scene scene = makeScene("bumpy-sphere", 5'000);
  const RigidMotion motion{.kind = MotionKind::turn, .axis = {0.6, 0, 0.8}, .frequency_Hz = 1};
  MovingCloud source(scene.cloud, motion), same(scene.cloud, motion);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .source = &source});
  CpuTouch cpu(scene.cloud, {.radius = scene.radius, .threads = 1, .source = &same});
  std::size_t touched = 0, other = 0;
  const auto path = wanderingPath(scene, 80, 0.3 * scene.radius, 5);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Pose pose{.time_s = kTick_s * static_cast<double>(i), .hip = path[i]};
    const Contact a = touch.query(pose, 0), b = cpu.query(pose, 0);
    touched += a.touching;
    other += a.touching != b.touching || glm::distance(a.proxy, b.proxy) > 1e-3 * scene.radius;
  }
  CHECK(touched > 10);
  CHECK(other <= 1);  // single precision may find a crossing a tick later
  touch.finish();
  PointCloud end = scene.cloud;
  touch.readBack(end);
  CloudFrame frame, truth;
  source.makeFrame(kTick_s * 79, truth);
  CHECK(end.positions == truth.positions);
  CHECK(touch.frames()->take(frame));
  CHECK(frame.time_s == truth.time_s);
  CHECK(frame.positions == truth.positions);
  CHECK(frame.normals == truth.normals);
  CHECK_FALSE(touch.frames()->take(frame));
}

TEST_CASE_FIXTURE(GpuFixture, "the points of a moving cloud keep their ids") {
  const Scene scene = makeScene("sphere", 2'000);
  MovingCloud source(scene.cloud, oscillation());
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .source = &source});
  feelAtRest(touch, {1, 2, 50}, 40);
  touch.finish();
  auto points = touch.live().points();
  std::ranges::sort(points, {}, &PointState::number);
  for (std::uint32_t i = 0; i < points.size(); ++i) CHECK(points[i].number == i);
  CHECK(points.size() == scene.cloud.size());
}

TEST_CASE_FIXTURE(GpuFixture, "clouds of awkward sizes move correctly") {
  for (const std::size_t count : {1, 2, 255, 256, 257, 511, 513, 1025}) {
    CAPTURE(count);
    const Scene scene = makeScene("plane", count);
    MovingCloud source(scene.cloud, {.amplitude = 3, .frequency_Hz = 5});
    TouchSide touch(device, scene.cloud, {.radius = 30, .source = &source});
    for (int i = 0; i <= 8; ++i) CHECK(touch.query({.time_s = kTick_s * i, .hip = {0.5, 0.5, 10 - 2.0 * i}}, 0).valid);
    touch.finish();
    PointCloud end = scene.cloud;
    touch.readBack(end);
    CloudFrame truth;
    source.makeFrame(kTick_s * 8, truth);
    CHECK(end.positions == truth.positions);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "points that crowd into one bucket and leave it again do not change contacts") {
  const Scene scene = makeScene("sphere", 3'000);
  CrowdingSource source(scene.cloud);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .source = &source});
  TouchSide alone(device, scene.cloud, {.radius = scene.radius});
  const DVec3 above(0, 0, 50.5), inside(0, 0, 49.5);
  for (int i = 0; i < 8; ++i) CHECK(touch.query({.time_s = kTick_s * i, .hip = above}, 0).valid);
  alone.query({.hip = above}, 0);
  touch.resetHand(0);
  alone.resetHand(0);
  for (const DVec3& hip : {above, inside}) {
    const Contact a = touch.query({.time_s = 0.1, .hip = hip}, 0), b = alone.query({.time_s = 0.1, .hip = hip}, 0);
    CHECK(sameAnswer(a, b));
    CHECK(a.touching == (hip == inside));
  }
}

TEST_CASE_FIXTURE(CoreGpuFixture, "with more frames than ticks, no frame is felt after a newer one") {
  const Scene scene = makeScene("sphere", 20'000);
  MovingCloud source(scene.cloud, oscillation());
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .source = &source});
  double last_s = 0;
  int newer = 0;
  const Stopwatch since;
  for (int i = 1; i <= 200 || (newer <= 5 && since.elapsed_s() < 60); ++i) {
    CHECK(touch.query({.time_s = kTick_s * i, .hip = {0, 0, 51}}, 200'000).valid);
    const double now_s = touch.frames()->time()->true_s;
    CHECK(now_s >= last_s);
    newer += now_s > last_s;
    last_s = now_s;
    if (i % 4 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));  // a frame or more
  }
  CHECK(newer > 5);
}

}  // namespace palpate::gpu_moving_test
