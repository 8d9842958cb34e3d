// The same path on the CPU and on the GPU: the same contacts, and the same points moved to the same positions.
#include <algorithm>

#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/scenes.hpp"

namespace palpate::backends_agree_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

class BackendsFixture : public GpuFixture {
 protected:
  struct Outcome {
    std::size_t touched = 0, disagreed = 0;
    double worstProxy = 0;  // distance of the proxies, support radii
    double worstNormal_deg = 0;
    PointCloud onGpu, onCpu;
    std::size_t movedOnGpu = 0, movedOnCpu = 0;
  };

  // Insertions and removals can depend on rounding; without resample there are none.
  Outcome play(const Scene& scene, const std::vector<DVec3>& path, std::optional<BrushOptions> push = {}) {
    if (push) push->resample = false;
    TouchSide gpu(device, scene.cloud, {.radius = scene.radius, .brush = push});
    CpuTouch cpu(scene.cloud, {.radius = scene.radius, .brush = push});
    Outcome outcome{.onGpu = scene.cloud, .onCpu = scene.cloud};
    double time_s = 0;
    for (const DVec3& hip : path) {
      const Pose pose{.time_s = time_s += 1e-3, .hip = hip};
      const Contact a = gpu.query(pose, 0), b = cpu.query(pose, 0);
      CHECK(a.valid);
      CHECK(b.valid);
      outcome.touched += b.touching;
      outcome.disagreed += a.touching != b.touching;
      outcome.worstProxy = std::max(outcome.worstProxy, glm::distance(a.proxy, b.proxy) / scene.radius);
      if (a.touching && b.touching)
        outcome.worstNormal_deg = std::max(outcome.worstNormal_deg, angleBetween_deg(a.normal, b.normal));
    }
    gpu.finish();
    cpu.finish();
    CHECK(gpu.report().firstEdit_s == cpu.report().firstEdit_s);
    CHECK(gpu.report().editTimes_us.size() == cpu.report().editTimes_us.size());
    outcome.movedOnGpu = gpu.readBack(outcome.onGpu);
    outcome.movedOnCpu = cpu.readBack(outcome.onCpu);
    return outcome;
  }
};

std::vector<DVec3> press(const DVec3& outward, double depth, int ticks) {
  std::vector<DVec3> path;
  for (int i = 0; i <= ticks; ++i) path.push_back((51 - (1 + depth) * std::min(1.0, i / (0.5 * ticks))) * outward);
  return path;
}

double worstDistance(const PointCloud& a, const PointCloud& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, glm::distance(DVec3(a.positions[i]), DVec3(b.positions[i])));
  return worst;
}

}  // namespace

TEST_CASE_FIXTURE(BackendsFixture, "CPU and GPU agree on a static cloud of every shape") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(name);
    const Scene scene = makeScene(name, 5'000);
    const Outcome outcome = play(scene, wanderingPath(scene, 80, 0.5 * scene.radius, 2));
    CHECK(outcome.touched > 12);
    CHECK(outcome.disagreed == 0);
    CHECK(outcome.worstProxy < 1e-4);
    CHECK(outcome.worstNormal_deg < 0.1);
    CHECK(outcome.movedOnGpu + outcome.movedOnCpu == 0);
  }
}

TEST_CASE_FIXTURE(BackendsFixture,
                  "one edit moves the same points to the same positions on CPU and GPU, within rounding") {
  const Scene scene = makeScene("sphere", 20'000);
  const DVec3 outward = glm::normalize(DVec3(1, 2, 2));
  const Outcome outcome =
      play(scene, {51.0 * outward, 47.0 * outward}, BrushOptions{.yieldDepth = 0.3, .pushRate = 0.5, .radius = 8});
  CHECK(outcome.movedOnCpu > 50);
  // A point within rounding of the brush's border may move on one side only, by less than the tolerance.
  CHECK(std::abs(static_cast<double>(outcome.movedOnCpu) - static_cast<double>(outcome.movedOnGpu)) <= 2);
  CHECK(worstDistance(outcome.onGpu, outcome.onCpu) < 1e-4 * scene.radius);
  double worst_deg = 0;
  for (std::size_t i = 0; i < outcome.onCpu.size(); ++i)
    worst_deg = std::max(worst_deg, angleBetween_deg(DVec3(outcome.onGpu.normals[i]), DVec3(outcome.onCpu.normals[i])));
  CHECK(worst_deg < 0.1);
}

TEST_CASE_FIXTURE(BackendsFixture, "a press that sculpts agrees on CPU and GPU, tick by tick") {
  const Scene scene = makeScene("sphere", 20'000);
  const Outcome outcome =
      play(scene, press(DVec3(0, 0, 1), 3, 100), BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8});
  CHECK(outcome.touched > 50);
  CHECK(outcome.disagreed == 0);
  CHECK(outcome.worstProxy < 1e-4);
  CHECK(outcome.worstNormal_deg < 0.1);
  CHECK(outcome.movedOnCpu > 50);
  CHECK(worstDistance(outcome.onGpu, outcome.onCpu) < 1e-3 * scene.radius);
}

TEST_SUITE_END();

}  // namespace palpate::backends_agree_test
