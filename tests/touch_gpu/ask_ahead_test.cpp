// Questions that are submitted before their pose is known.
#include <chrono>
#include <thread>

#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/scenes.hpp"

namespace palpate::ask_ahead_test {

namespace {

TouchOptions optionsFor(const Scene& scene, bool ahead) { return {.radius = scene.radius, .ahead = ahead}; }

// Down to the sphere, into it, along it and out again.
Pose poseAt(int tick) {
  const double way = 0.02 * tick, height = tick < 60 ? 52 - 0.05 * tick : tick < 160 ? 49 : 49 + 0.1 * (tick - 160);
  return {.time_s = 1e-3 * tick, .hip = height * glm::normalize(DVec3(std::sin(way), 0.1, std::cos(way)))};
}
constexpr int kTicks = 200, kStride = 2;  // kStride: ticks that most cases advance at once

void checkEqual(const Contact& a, const Contact& b) {
  CHECK(a.valid);
  CHECK(a.fresh);
  CHECK(a.proxy == b.proxy);
  CHECK(a.normal == b.normal);
  CHECK(a.touching == b.touching);
  CHECK(a.neighbours == b.neighbours);
}

}  // namespace

TEST_CASE("questions asked ahead give the same answers and the same sculpted cloud, bit by bit") {
  // Without validation, which makes a submission wait until its work is done.
  Device& device = plainDevice();
  const Scene scene = makeScene("sphere", 5'000);
  for (const bool sculpts : {false, true}) {
    CAPTURE(sculpts);
    TouchOptions plain = optionsFor(scene, false), ahead = optionsFor(scene, true);
    if (sculpts) plain.brush = ahead.brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8};
    TouchSide a(device, scene.cloud, plain), b(device, scene.cloud, ahead);
    CHECK_FALSE(a.asksAhead());
    CHECK(b.asksAhead());
    std::uint64_t touching = 0, questions = 0;
    for (int tick = 0; tick < kTicks; tick += kStride, ++questions) {
      const Contact expected = a.query(poseAt(tick), 0);
      b.endTick();  // right before the next pose, which a software driver then awaits in time
      const Pose pose = poseAt(tick);
      checkEqual(b.ask({&pose, 1}, 0).front(), expected);
      touching += expected.touching;
    }
    b.endTick();
    a.finish();
    b.finish();
    CHECK(touching > questions / 3);
    CHECK(a.answeredAhead() == 0);
    // Whether a software driver starts a question before its timeout depends on the load of its cores.
    CHECK(b.answeredAhead() > (device.isCpu() ? 0 : questions / 2));
    PointCloud left = scene.cloud, right = scene.cloud;
    CHECK(a.readBack(left) == b.readBack(right));
    CHECK(left.positions == right.positions);
    CHECK(sculpts == (left.positions != scene.cloud.positions));
  }
}

TEST_CASE("questions of a tool's points and of two hands are asked ahead together, all answered or none" *
          kMoreInFull) {
  Device& device = plainDevice();
  const Scene scene = makeScene("sphere", 5'000);
  for (const std::size_t points : byTier<std::vector<std::size_t>>({0, 8}, {0, 8, 64})) {
    CAPTURE(points);
    TouchOptions plain = optionsFor(scene, false), ahead = optionsFor(scene, true);
    plain.friction = ahead.friction = 0.3;
    plain.tools = ahead.tools = {points > 0 ? makeTool(ToolKind::pad, points, 6) : ToolShape(), ToolShape()};
    TouchSide a(device, scene.cloud, plain), b(device, scene.cloud, ahead);
    REQUIRE(b.asksAhead());
    std::uint64_t touching = 0, questions = 0;
    for (int tick = 0; tick < kTicks; tick += kStride, ++questions) {
      CAPTURE(tick);
      const std::array poses{poseAt(tick), Pose{.time_s = poseAt(tick).time_s, .hip = -poseAt(kTicks - tick).hip}};
      if (tick == 120) a.resetHand(1);
      const auto expected = a.query(poses, 0);
      b.endTick();
      if (questions % 25 == 24) b.finish();
      if (questions % 30 == 29) std::this_thread::sleep_for(std::chrono::milliseconds(device.isCpu() ? 60 : 0));
      if (questions % 20 == 19) b.finish();  // withdraws them
      if (tick == 120) b.resetHand(1);
      const auto answers = b.ask(poses, 0);
      checkEqual(answers[0], expected[0]);
      checkEqual(answers[1], expected[1]);
      REQUIRE(a.points(0).size() == b.points(0).size());
      for (std::size_t i = 0; i < a.points(0).size(); ++i) checkEqual(b.points(0)[i].contact, a.points(0)[i].contact);
      touching += expected[0].touching && expected[1].touching;
    }
    CHECK(touching > questions / 10);
    CHECK(b.answeredAhead() > (device.isCpu() ? 0 : questions / 2));
  }
}

TEST_CASE("a question ahead that times out is asked again") {
  Device& device = plainDevice();
  const Scene scene = makeScene("sphere", 5'000);
  TouchSide plain(device, scene.cloud, optionsFor(scene, false)), ahead(device, scene.cloud, optionsFor(scene, true));
  for (int tick = 58; tick < 70; ++tick) {
    ahead.endTick();
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    checkEqual(ahead.query(poseAt(tick), 0), plain.query(poseAt(tick), 0));
  }
  CHECK(ahead.answeredAhead() == 0);
}

TEST_CASE("a withdrawn question does not affect later contacts") {
  Device& device = plainDevice();
  const Scene scene = makeScene("sphere", 5'000);
  TouchSide plain(device, scene.cloud, optionsFor(scene, false)), ahead(device, scene.cloud, optionsFor(scene, true));
  int touching = 0;
  for (int tick = 40; tick < 90; ++tick) {
    ahead.endTick();
    ahead.finish();
    const Contact expected = plain.query(poseAt(tick), 0);
    checkEqual(ahead.query(poseAt(tick), 0), expected);
    touching += expected.touching;
  }
  CHECK(touching > 10);
}

TEST_CASE("in real time no question waits for a hand that rests away from all surfaces") {
  Device& device = plainDevice();
  const Scene scene = makeScene("sphere", 5'000);
  TouchSide touch(device, scene.cloud, optionsFor(scene, true));
  constexpr double kInRealTime_us = 1e6, kTick_s = 0.01;
  double time_s = 0;
  // Whether a question waits after the hand was there for so long.
  const auto waitsAfter = [&](double duration_s, const DVec3& hip) {
    for (const double end_s = time_s + duration_s; time_s < end_s; time_s += kTick_s) {
      REQUIRE(touch.query({.time_s = time_s, .hip = hip}, kInRealTime_us).valid);
      // A late answer of a software driver needs its time, and a core.
      std::this_thread::sleep_for(std::chrono::milliseconds(device.isCpu() ? 3 : 0));
    }
    return touch.waitsForPose();
  };
  // Whether one waits in any of these ticks: after an answer that comes late, as on a busy machine, none is submitted.
  const auto waitsWithin = [&](double duration_s, const DVec3& hip) {
    bool waits = false;
    for (const double end_s = time_s + duration_s; time_s < end_s && !waits;) waits = waitsAfter(kTick_s / 2, hip);
    return waits;
  };
  const DVec3 away(0, 0, 90), near(0, 0, 50.5), beside(0, 1, 90);
  CHECK(waitsWithin(0.1, away));
  CHECK(!waitsAfter(0.3, away));
  CHECK(waitsWithin(0.1, beside));  // it moves
  CHECK(!waitsAfter(0.3, beside));
  waitsAfter(0.5, near);
  CHECK(waitsWithin(0.3, near));
  CHECK(!waitsAfter(0.3, away));
}

TEST_CASE(
    "in real time a hand that rests away from all surfaces asks in few ticks, and at once when it moves or must") {
  Device& device = plainDevice();
  const Scene scene = makeScene("sphere", 5'000);
  TouchOptions options = optionsFor(scene, false);
  options.brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8, .resample = false};
  TouchSide touch(device, scene.cloud, options);
  touch.edits()->keep();
  constexpr double kTick_s = 0.001;
  double time_s = 0;
  // Number of questions in so many ticks, each of which waits for its answer, on a busy machine for long.
  const auto asked = [&](int ticks, const DVec3& hip, double budget_us = 6e7) {
    const std::uint32_t before = touch.questions();
    for (int i = 0; i < ticks; ++i) REQUIRE(touch.query({.time_s = time_s += kTick_s, .hip = hip}, budget_us).valid);
    return touch.questions() - before;
  };
  const DVec3 away(0, 0, 90), beside(0, 1, 90), inside(0, 0, 49);
  asked(300, away);
  const std::uint32_t resting = asked(320, away);
  CHECK(resting >= 1);
  CHECK(resting <= 320 / 16 + 1);
  CHECK(asked(1, beside) == 1);
  CHECK(asked(100, beside) > 20);  // it may go on
  asked(300, beside);
  CHECK(asked(16, beside) <= 2);
  // What others offer is carried out at once.
  PointState to = touch.live().points().front();
  const PointState from = to;
  to.position += Vec3(0, 0, 1);
  REQUIRE(touch.edits()->offer(std::vector<PointChange>{{from, to}}, 0));
  EditBatch batch;
  for (int tick = 0; tick < 12 && batch.points.empty(); ++tick) {
    asked(1, beside);
    touch.edits()->take(batch);
  }
  CHECK(batch.points.size() == 1);
  asked(300, beside);
  CHECK(asked(1, inside) == 1);
  CHECK(asked(320, inside) > 320 / 16 + 1);
  touch.finish();
  CHECK(asked(20, away, 0) == 20);  // in virtual time each pose has its own answer
  CHECK(asked(400, away, 0) == 400);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "a question pending ahead does not block finish(), a change or a slow driver") {
  const Scene scene = makeScene("sphere", 5'000);
  TouchOptions options = optionsFor(scene, true);
  options.brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8};
  TouchSide touch(device, scene.cloud, options);
  TouchSide plain(device, scene.cloud, optionsFor(scene, false));
  touch.endTick();
  touch.endTick();
  checkEqual(touch.query(poseAt(0), 0), plain.query(poseAt(0), 0));
  touch.endTick();
  touch.finish();
  touch.endTick();
  PointState to = touch.live().points().front();
  const PointState from = to;
  to.position += Vec3(0, 0, 1);
  touch.edits()->change(std::vector<PointChange>{{from, to}});
  touch.endTick();
  CHECK(touch.query(poseAt(1), 0).valid);
  PointCloud cloud = scene.cloud;
  touch.endTick();
  touch.finish();
  CHECK(touch.readBack(cloud) == 1);
  touch.endTick();  // pending when the touch side is destroyed
}

TEST_CASE_FIXTURE(GpuFixture, "by default a device asks ahead only if the driver is known to let a question wait") {
  const Scene scene = makeScene("sphere", 1'000);
  // Under validation every submission waits for its completion, on every driver.
  if (askedValidation() == Validation::off)
    MESSAGE("skipped: without validation (PALPATE_TESTS_VALIDATE=0) the driver decides whether a question waits");
  else
    CHECK_FALSE(TouchSide(device, scene.cloud, {.radius = scene.radius}).asksAhead());
  for (const auto& [name, method] : builtMethods())
    if (method != QueryMethod::fused)
      CHECK_FALSE(
          TouchSide(device, scene.cloud, {.radius = scene.radius, .method = method, .ahead = true}).asksAhead());
}

}  // namespace palpate::ask_ahead_test
