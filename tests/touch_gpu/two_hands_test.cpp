// Two hands on one cloud: each is answered as if it were alone, both from the same points.
#include <array>

#include "engine/core/error.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/busy.hpp"

namespace palpate::two_hands_test {

namespace {

constexpr double kTick_s = 1e-3, kFriction = 0.3;
const BrushOptions kPush{.yieldDepth = 0.3, .pushRate = 0.5, .radius = 8};

struct Wanted {
  std::vector<ToolShape> tools = std::vector<ToolShape>(2);
  std::optional<BrushOptions> brush = {};
};
const Wanted kAlone{.tools = std::vector<ToolShape>(1)};

/// One tick of two hands.
std::span<const Contact> ask(TouchBackend& touch, double time_s, const DVec3& first, const DVec3& second,
                             double budget_us = 0) {
  return touch.ask(std::array{Pose{.time_s = time_s, .hip = first}, Pose{.time_s = time_s, .hip = second}}, budget_us);
}

std::unique_ptr<TouchBackend> gpuTouch(Device& device, const Scene& scene, const Wanted& wanted) {
  return std::make_unique<TouchSide>(
      device, scene.cloud,
      TouchOptions{.radius = scene.radius, .friction = kFriction, .tools = wanted.tools, .brush = wanted.brush});
}

/// One device for all tests, without validation except for tests of the shader's memory accesses.
class HandsFixture {
 protected:
  Device& device = plainDevice();
  std::unique_ptr<TouchBackend> make(bool onGpu, const Scene& scene, const Wanted& wanted = {}) {
    if (onGpu) return gpuTouch(device, scene, wanted);
    return std::make_unique<CpuTouch>(
        scene.cloud,
        CpuTouchOptions{
            .radius = scene.radius, .friction = kFriction, .tools = wanted.tools, .brush = wanted.brush, .threads = 2});
  }
};

bool equal(const Contact& a, const Contact& b) {
  return a.valid && b.valid && a.fresh && b.fresh && a.proxy == b.proxy && a.normal == b.normal &&
         a.touching == b.touching && a.neighbours == b.neighbours;
}

/// Both wander on their own paths: how often they touched, and how often an answer differed from that of the hand
/// alone.
struct Wandering {
  std::size_t firstTouched = 0, secondTouched = 0, different = 0;
};
Wandering wander(TouchBackend& together, TouchBackend& first, TouchBackend& second, const Scene& scene,
                 std::size_t ticks) {
  const auto ways = std::array{wanderingPath(scene, ticks, 0.5 * scene.radius, 2),
                               wanderingPath(scene, ticks, 0.5 * scene.radius, 9)};
  Wandering wander;
  for (std::size_t i = 0; i < ticks; ++i) {
    const double time_s = kTick_s * static_cast<double>(i);
    const auto answers = ask(together, time_s, ways[0][i], ways[1][i]);
    const Contact a = first.query({.time_s = time_s, .hip = ways[0][i]}, 0);
    const Contact b = second.query({.time_s = time_s, .hip = ways[1][i]}, 0);
    wander.firstTouched += a.touching;
    wander.secondTouched += b.touching;
    wander.different += !equal(answers[0], a) + !equal(answers[1], b);
    together.prepare();
  }
  return wander;
}

}  // namespace

TEST_CASE_FIXTURE(HandsFixture, "each of two hands is answered as if alone, bit by bit") {
  for (const bool onGpu : {false, true})
    for (const std::string_view name : {"sphere", "bumpy-sphere", "cube"}) {
      CAPTURE(onGpu);
      CAPTURE(name);
      const Scene scene = makeScene(name, 10'000);
      const auto together = make(onGpu, scene), first = make(onGpu, scene, kAlone), second = make(onGpu, scene, kAlone);
      const Wandering both = wander(*together, *first, *second, scene, 150);
      CHECK(both.firstTouched > 30);
      CHECK(both.secondTouched > 30);
      CHECK(both.different == 0);
    }
}

TEST_CASE_FIXTURE(GpuFixture, "two hands run under validation, with edits and a restart") {
  const Scene scene = makeScene("sphere", 10'000);
  const auto touch = gpuTouch(device, scene, {.brush = kPush});
  std::span<const Contact> answers;
  for (int i = 0; i < 30; ++i) {
    const double r = 53 - 0.2 * i;
    answers = ask(*touch, kTick_s * i, {0, 0, r}, {r, 0, 0});
    REQUIRE(answers[0].valid);
    REQUIRE(answers[1].valid);
    touch->prepare();
  }
  CHECK(answers[1].touching);
  CHECK(answers[1].proxy.x == near(50, 3e-3));
  CHECK(touch->report().firstEdit_s);
  touch->resetHand(1);
  answers = ask(*touch, 1, {0, 0, 47}, {47, 0, 0});
  CHECK(answers[0].touching);
  CHECK_FALSE(answers[1].touching);
  touch->finish();
}

TEST_CASE_FIXTURE(HandsFixture, "a tool of many points belongs to the first hand, and the second one has its point") {
  const Scene scene = makeScene("bumpy-sphere", 10'000);
  const ToolShape pad = makeTool(ToolKind::pad, 6, 8);
  for (const bool onGpu : {false, true}) {
    CAPTURE(onGpu);
    const auto together = make(onGpu, scene, {.tools = {pad, ToolShape()}}),
               first = make(onGpu, scene, {.tools = {pad}}), second = make(onGpu, scene, kAlone);
    const Wandering both = wander(*together, *first, *second, scene, 80);
    CHECK(together->points(0).size() == 6);
    CHECK(together->points(1).empty());
    CHECK(both.secondTouched > 10);
    CHECK(both.different == 0);
  }
}

TEST_CASE_FIXTURE(HandsFixture, "the second hand feels the edits of the first, with the answer of the next tick") {
  const Scene scene = makeScene("sphere", 20'000);
  for (const bool onGpu : {false, true}) {
    CAPTURE(onGpu);
    const auto touch = make(onGpu, scene, {.brush = kPush}),
               alone = make(onGpu, scene, {.tools = kAlone.tools, .brush = kPush});
    // The second hand rests 6 deep at the pole; the first one descends close to it.
    const auto restingAt = [](int i) { return DVec3(0.6, 0, std::max(44.0, 52 - 0.5 * i)); };
    double atRest = 0, afterEdit = 0, last = 0;
    bool same = true;
    for (int i = 0; i < 120; ++i) {
      const double time_s = kTick_s * i;
      const DVec3 hip(0, 0, 52 - 4.5 * std::clamp((i - 40) / 50.0, 0.0, 1.0));
      const auto answers = ask(*touch, time_s, hip, restingAt(i));
      same = same && equal(answers[0], alone->query({.time_s = time_s, .hip = hip}, 0));
      REQUIRE(answers[1].valid);
      REQUIRE(answers[1].touching == (i > 4));
      last = answers[1].proxy.z;
      const auto edited_s = touch->report().firstEdit_s;
      if (i >= 35 && (!edited_s || *edited_s == time_s)) atRest = last;
      if (edited_s && std::abs(time_s - *edited_s - kTick_s) < 1e-9) afterEdit = last;
    }
    touch->finish();
    alone->finish();
    CHECK(same);  // the first hand feels and does the same as without the second
    CHECK(atRest == near(50, 0.002));
    CHECK(afterEdit < atRest - 1e-4);
    CHECK(last < atRest - 1);
    CHECK(last > 44);
    PointCloud left = scene.cloud, right = scene.cloud;
    CHECK(touch->readBack(left) > 30);
    alone->readBack(right);
    CHECK(left.positions == right.positions);
  }
}

TEST_CASE_FIXTURE(HandsFixture, "one hand is put down elsewhere, and the other continues") {
  const Scene scene = makeScene("plane", 10'000);
  for (const bool onGpu : {false, true})
    for (const bool secondGoes : {false, true}) {
      CAPTURE(onGpu);
      CAPTURE(secondGoes);
      const auto touch = make(onGpu, scene);
      const auto bothAt = [&](double z) { return ask(*touch, 0, {3, 0.2, z}, {-3, 0.3, z}); };
      std::span<const Contact> answers;
      for (double z = 4; z > -2; z -= 0.25) answers = bothAt(z);
      CHECK(answers[0].touching);
      CHECK(answers[1].touching);
      touch->resetHand(secondGoes ? 1 : 0);
      answers = bothAt(-2);
      // Put down inside the surface, it is not caught until it has been outside.
      CHECK(answers[0].touching == secondGoes);
      CHECK(answers[1].touching == !secondGoes);
      bothAt(4);
      answers = bothAt(-1);
      CHECK(answers[0].touching);
      CHECK(answers[1].touching);
    }
}

TEST_CASE_FIXTURE(HandsFixture, "a position of the second hand that is not finite is a fault at that pose only") {
  const Scene scene = makeScene("plane", 5'000);
  for (const bool onGpu : {false, true}) {
    CAPTURE(onGpu);
    const auto touch = make(onGpu, scene);
    for (const double bad : {std::nan(""), 1e300}) {
      const auto answers = ask(*touch, 0, {0, 0, 3}, {0, bad, 0});
      CHECK_FALSE(answers[0].lost);
      CHECK_FALSE(answers[1].valid);
    }
    std::span<const Contact> answers;
    for (double z = 3; z > -1; z -= 0.25) answers = ask(*touch, 0, {3, 0, z}, {-3, 0, z});
    CHECK(answers[1].touching);
    CHECK(answers[1].normal.z == near(1, 1e-5));
  }
}

TEST_CASE_FIXTURE(HandsFixture, "when the answer is late the second hand keeps its plane, and fades out") {
  const Scene scene = makeScene("plane", 20'000);
  TouchSide touch(
      device, scene.cloud,
      {.radius = scene.radius, .friction = kFriction, .tools = std::vector<ToolShape>(2), .wait = Wait::block});
  double time_s = 0;
  std::span<const Contact> answers;
  for (double z = 2; z > -1; z -= 0.25) answers = ask(touch, time_s += kTick_s, {3, 0.2, z}, {-3, 0.3, z}, 1e7);
  REQUIRE(answers[0].fresh);
  REQUIRE(answers[1].fresh);
  REQUIRE(answers[1].touching);
  const Busy busy(device, 200);
  const auto secondAt = [&](double age_s, double z, double budget_us) {
    return ask(touch, time_s + age_s, {3, 0.2, -1}, {-3, 0.3, z}, budget_us)[1];
  };
  const auto late = [&](double age_s, double z) { return secondAt(age_s, z, 1); };
  Contact held = late(0.002, -1.5);
  CHECK_FALSE(held.fresh);
  CHECK(held.valid);
  CHECK(held.touching);
  CHECK(held.proxy.z == within(0, 1e-3));
  CHECK(held.dataTime_s == time_s);
  held = late(0.0125, -1.5);
  CHECK(held.proxy.z == near(-0.75, 1e-2));
  held = late(0.021, -1.5);
  CHECK_FALSE(held.touching);
  CHECK(held.valid);

  CHECK(secondAt(0.022, -1.5, 0).touching);
  // Put down elsewhere while a question is pending: the answer to its old position does not hold it.
  const Busy busyAgain(device, 100);
  CHECK(late(0.023, -1.5).touching);
  touch.resetHand(1);
  const Busy stillBusy(device, 100);
  held = late(0.024, -1.5);
  CHECK_FALSE(held.fresh);
  CHECK_FALSE(held.touching);
  held = secondAt(0.025, -1.5, 0);
  CHECK(held.fresh);
  CHECK_FALSE(held.touching);
  touch.finish();
}

TEST_CASE_FIXTURE(HandsFixture,
                  "two hands require the fused method, are asked ahead like one, and continue after a change") {
  const Scene scene = makeScene("sphere", 5'000);
  for (const QueryMethod method : {QueryMethod::brute, QueryMethod::indirect, QueryMethod::naive, QueryMethod::twoStep})
    CHECK_THROWS_WITH_AS(
        TouchSide(device, scene.cloud, {.radius = scene.radius, .method = method, .tools = std::vector<ToolShape>(2)}),
        doctest::Contains("several hands"), UsageError);
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius, .friction = kFriction, .tools = std::vector<ToolShape>(2), .ahead = true});
  CHECK(touch.asksAhead());
  CHECK(touch.passes().size() == 1);  // one dispatch for both
  const auto press = [&] {
    Contact second;
    for (double r = 53; r > 48; r -= 0.2) second = ask(touch, 0, {0, 0, r}, {r, 0, 0})[1];
    return second;
  };
  CHECK(press().touching);
  CHECK_THROWS_AS(touch.setContact(SurfaceKind::sphere, 0, "indirect"), UsageError);
  touch.setContact(SurfaceKind::sphere, kFriction, "fused");
  const Contact contact = press();
  CHECK(contact.touching);
  CHECK(contact.proxy.x == near(50, 1e-3));
}

}  // namespace palpate::two_hands_test
