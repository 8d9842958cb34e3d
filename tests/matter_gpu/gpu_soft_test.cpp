// Soft bodies whose points are felt on a GPU and moved there or on the CPU: the same as on the CPU alone.
#include <chrono>
#include <limits>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"
#include "engine/matter/gpu_soft_world.hpp"
#include "engine/matter/soft_sculpture.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/history_steps.hpp"
#include "tests/matter/soft_scene.hpp"
#include "tests/near.hpp"

namespace palpate::gpu_soft_test {

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
  // On its own queue.
  BodyMaker movedOnGpu() {
    return [this](const MatterScene& scene, const MatterOptions& matter) {
      return std::make_unique<GpuSoftWorld>(device, device.backgroundQueue().another(), scene, matter);
    };
  }
  SoftTouching onlyOnGpu() {
    SoftTouching options;
    options.body = movedOnGpu();
    return options;
  }
  static SurfaceMaker onCpu() {
    return [](const PointCloud& cloud, CloudSource& source, double radius, const SoftTouchOptions& touch) {
      return std::make_unique<CpuTouch>(
          cloud,
          CpuTouchOptions{.radius = radius, .friction = touch.friction, .tools = touch.tools, .source = &source});
    };
  }
};

MatterScene lowBlock() {
  MatterScene scene = bareBlock();
  scene.fill_mm = {40, 30, 40};
  return scene;
}

// Above the centre of the low block, at this depth.
DVec3 atDepth(double depth) { return {50, 30 - depth, 50}; }

}  // namespace

TEST_CASE_FIXTURE(SoftFixture, "a soft body is felt and pressed by two hands on a GPU as on the CPU") {
  for (const bool moves : {false, true}) {
    CAPTURE(moves);
    SoftTouching options;
    options.touch.tools.resize(2);
    options.touch.friction = 0.3;
    SoftScene cpu(lowBlock(), options, onCpu());
    if (moves) options.body = movedOnGpu();
    SoftScene gpu(lowBlock(), options, onGpu());
    CHECK((gpu.source().carrier() != nullptr) == moves);
    std::size_t touched = 0, disagreed = 0;
    for (int k = 0; k < 150; ++k) {
      const double time_s = 1e-3 * k, y = 31 - 5 * std::min(1.0, k / 100.0);
      const std::array poses{Pose{.time_s = time_s, .hip = {44 + 0.02 * k, y, 50}},
                             Pose{.time_s = time_s, .hip = {57, y + 1, 50}}};
      const auto a = gpu.touch().query(poses, 0);
      const auto b = cpu.touch().query(poses, 0);
      for (std::size_t i = 0; i < 2; ++i) {
        CHECK(a[i].valid);
        CHECK(b[i].valid);
        touched += b[i].touching;
        disagreed += a[i].touching != b[i].touching;
        CHECK(glm::distance(a[i].proxy, b[i].proxy) < 0.02);
      }
    }
    CHECK(touched > 150);
    CHECK(disagreed <= 4);
    const PointCloud there = gpu.points(), here = cpu.points();
    REQUIRE(there.size() == here.size());
    for (std::size_t i = 0; i < here.size(); ++i) {
      CHECK(glm::distance(there.positions[i], here.positions[i]) < 0.02f);
      CHECK(glm::distance(there.normals[i], here.normals[i]) < 0.01f);
    }
    const DVec3 given = cpu.world().impulses().onTools;
    CHECK(glm::distance(gpu.world().impulses().onTools, given) < 0.01 * glm::length(given));
  }
}

TEST_CASE_FIXTURE(SoftFixture,
                  "on a GPU a soft body receives the force that the hand feels, and momentum is conserved") {
  SoftTouching options = onlyOnGpu();
  options.touch.friction = 0.6;
  SoftScene block(lowBlock(), options, onGpu());
  FeltSpring spring(options.spring);
  DVec3 felt(0);
  for (int k = 0; k < 300; ++k) {
    Pose pose{.time_s = 1e-3 * k, .hip = atDepth(-1 + 6 * std::min(1.0, k / 150.0))};
    pose.hip.x += 8 * std::max(0.0, 1e-3 * k - 0.15);
    felt += 1e-3 * spring.add(block.touch().query(pose, 0), pose.hip, 1e-3);
  }
  const MatterImpulses& given = block.world().impulses();
  CHECK(felt.y > 0.05);
  CHECK(std::abs(given.onTools.y - felt.y) < 0.01 * felt.y);
  CHECK(std::abs(given.onTools.x - felt.x) < 0.02 * felt.y);
  const DVec3 missing = block.world().totals().momentum - (given.gravity - given.onWalls - given.onTools);
  CHECK(glm::length(missing) <= 1e-5 * (glm::length(given.gravity) + glm::length(given.onTools)));
}

TEST_CASE_FIXTURE(SoftFixture,
                  "the same GPU gives the same results bit by bit for the same poses, also after a restart") {
  SoftScene one(lowBlock(), onlyOnGpu(), onGpu()), other(lowBlock(), onlyOnGpu(), onGpu());
  // The body is also touched within the first 20 ms, while a surface that may still appear is not felt.
  const auto play = [](SoftScene& scene) {
    std::vector<DVec3> proxies;
    for (int k = 0; k < 40; ++k)
      proxies.push_back(scene.touch().query({.time_s = 1e-3 * k, .hip = atDepth(-3 + 0.2 * k)}, 0).proxy);
    return proxies;
  };
  const auto first = play(one);
  CHECK(first == play(other));
  const PointCloud there = one.points();
  CHECK(there.positions == other.points().positions);
  CHECK(there.normals == other.points().normals);
  CHECK(play(one) == first);
  CHECK(one.points().positions == there.positions);
}

TEST_CASE_FIXTURE(SoftFixture,
                  "a body on a GPU pauses, resumes and restarts, and gives no answers after a failure until then") {
  SoftScene block(lowBlock(), onlyOnGpu(), onGpu());
  int k = 0;
  const auto ask = [&](double depth) { return block.touch().query({.time_s = 1e-3 * k++, .hip = atDepth(depth)}, 0); };
  for (int i = 0; i < 80; ++i) ask(-2 + 0.06 * i);
  CHECK(ask(3).touching);
  const PointCloud dented = block.points();
  SimulationControl& control = *block.touch().simulation();
  control.pause(true);
  for (int i = 0; i < 5; ++i) CHECK_FALSE(ask(3).touching);
  CHECK(block.points().positions == dented.positions);
  control.pause(false);
  for (int i = 0; i < 30; ++i) ask(-4);
  CHECK(block.points().positions != dented.positions);
  // A parameter changed during the simulation.
  control.set("young_Pa", 1e5);
  ask(-4);
  CHECK(block.world().scene().young_Pa == 1e5);
  auto& world = const_cast<MatterSimulation&>(block.world());
  world.setVelocities(std::vector<Vec3>(world.particles(), Vec3(std::numeric_limits<float>::quiet_NaN())));
  ask(-4);
  CHECK_FALSE(ask(1).valid);
  CHECK_THROWS_WITH_AS(block.touch().finish(), doctest::Contains("restart it"), Error);
  control.reset();
  for (int i = 0; i < 30; ++i) CHECK(ask(-4).valid);
  CHECK(block.world().time_s() < 0.04);
  const PointCloud begun = block.points();
  for (std::size_t i = 0; i < begun.size(); ++i)
    REQUIRE(glm::distance(begun.positions[i], block.cloud().positions[i]) < 1);
}

TEST_CASE_FIXTURE(SoftFixture,
                  "a dent in a body on a GPU is as deep as on the CPU, and its stroke is undone bit by bit") {
  SoftTouching options;
  options.touch.brush = BrushOptions{.kind = BrushKind::push, .yieldDepth = 0.5, .pushRate = 0.1, .radius = 12};
  SoftScene cpu(lowBlock(), options, onCpu());
  options.body = movedOnGpu();
  SoftScene gpu(lowBlock(), options, onGpu());
  const auto shapeOf = [](const SoftScene& scene) {
    const std::span<const Vec3> rest =
        const_cast<MatterSimulation&>(scene.world()).sculpture()->body().rest().displacements();
    return std::vector<Vec3>(rest.begin(), rest.end());
  };
  const auto deepest = [](const std::vector<Vec3>& shape) {
    double most = 0;
    for (const Vec3& node : shape) most = std::max(most, static_cast<double>(-node.y));
    return most;
  };
  for (SoftScene* scene : {&gpu, &cpu}) {
    int k = 0;
    const auto ask = [&](double depth, int ticks) {
      for (int i = 0; i < ticks; ++i)
        scene->touch().query({.time_s = 1e-3 * k++, .hip = atDepth(depth + 6 * std::min(0.0, 2.0 * i / ticks - 1))}, 0);
    };
    ask(4, 150);
    ask(-6, 340);  // long enough to end the stroke
  }
  const std::vector<Vec3> dent = shapeOf(gpu);
  CHECK(deepest(dent) > 5e-4);
  CHECK(deepest(dent) == near(deepest(shapeOf(cpu)), 0.03));
  ShapeHistory strokes(*gpu.touch().shapeStrokes());
  CHECK(strokes.counts().strokes == 1);
  const auto topOf = [](SoftScene& scene) {
    const PointCloud now = scene.points();
    float low = 100;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const Vec3& began = scene.cloud().positions[i];
      if (began.y > 29.9f && glm::length(glm::vec2(began.x - 50, began.z - 50)) < 3)
        low = std::min(low, now.positions[i].y);
    }
    return low;
  };
  const float dented = topOf(gpu);
  CHECK(strokes.undo());
  CHECK(shapeOf(gpu) == std::vector<Vec3>(dent.size(), Vec3(0)));
  // Its points have moved before the next query.
  CHECK(topOf(gpu) - dented > 0.4f);
  CHECK(strokes.redo());
  CHECK(shapeOf(gpu) == dent);
  CHECK(std::abs(topOf(gpu) - dented) < 0.2f);
}

TEST_CASE_FIXTURE(SoftFixture, "a body on a GPU holds a hand that presses deep into it, without a force step") {
  MatterScene scene = bareBlock();
  scene.fill_mm = {21, 21, 21};
  scene.spacing_mm = 3;
  const SoftTouching options = onlyOnGpu();
  SoftScene block(scene, options, onGpu());
  double before_N = 0, most_N = 0;
  for (int k = 0; k < 90; ++k) {
    const double depth = -4 + std::min(16.0, 0.2 * k), step_N = k <= 80 ? 0.5 * 0.2 : 0;
    const Pose pose{.time_s = 1e-3 * k, .hip = {50, 21 - depth, 50}};
    const Contact contact = block.touch().query(pose, 0);
    const double force_N = contact.touching ? 0.5 * glm::distance(contact.proxy, pose.hip) : 0;
    CAPTURE(depth);
    CHECK(contact.valid);
    CHECK(force_N > before_N - 0.1);
    CHECK(force_N < before_N + step_N + 0.1);
    if (most_N > 0.1) CHECK(force_N > 0);
    before_N = force_N;
    most_N = std::max(most_N, force_N);
  }
  CHECK(most_N > 1);
  CHECK(block.source().surfaceHolds().keptTicks > 0);
}

// The hand descends with simulated time and received answers, and stays until the body has absorbed some energy: a slow
// machine skips most of the time, answers few ticks, and lets the force end between them.
TEST_CASE_FIXTURE(SoftFixture, "in real time a body on a GPU is pressed beside queries, and reports dropped steps") {
  SoftTouching options = onlyOnGpu();
  options.realtime = true;
  MatterScene scene = bareBlock();
  scene.fill_mm = {20, 20, 20};
  SoftScene block(scene, options, onGpu());
  SimulationControl& control = *block.touch().simulation();
  constexpr double kWork_J = 2e-5;
  double simulated_s = 0, answered_mm = 0;
  int touched = 0;
  const Stopwatch watch;
  while (control.portEnergies().front().now_J < kWork_J && watch.elapsed_us() < 60e6) {
    const double time_s = watch.elapsed_us() * 1e-6;
    const double down = std::clamp(std::min(100 * (simulated_s - 0.03), answered_mm), 0.0, 5.0);
    const Pose pose{.time_s = time_s, .hip = {50, 22 - down, 50}};
    const Contact contact = block.touch().query(pose, 800);
    const double felt_s = block.touch().frames()->time().value_or(PointsTime{}).true_s;
    simulated_s = std::max(simulated_s, felt_s - control.dropped_s());
    CHECK(contact.valid);
    if (contact.fresh) answered_mm += 1;
    touched += contact.touching;
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  block.touch().finish();
  CHECK(touched > 0);
  CHECK(control.portEnergies().front().now_J >= kWork_J);
  CHECK(block.world().impulses().onTools.y > 1e-5);
  CHECK(block.world().time_s() + control.dropped_s() <= watch.elapsed_us() * 1e-6 + 1e-3);
}

}  // namespace palpate::gpu_soft_test
