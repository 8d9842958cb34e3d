// Several hands on the GPU; tests/touch/hands_test.cpp has the cases of each back end.
#include <array>

#include "engine/core/error.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/busy.hpp"
#include "tests/touch/tick.hpp"

namespace palpate::gpu_hands_test {

namespace {

constexpr double kFriction = 0.3;
const BrushOptions kPush{.yieldDepth = 0.3, .pushRate = 0.5, .radius = 8};

/// One tick of two hands.
std::span<const Contact> ask(TouchBackend& touch, double time_s, const DVec3& first, const DVec3& second,
                             double budget_us = 0) {
  return touch.query(std::array{Pose{.time_s = time_s, .hip = first}, Pose{.time_s = time_s, .hip = second}},
                     budget_us);
}

/// Without validation, except for tests of the shader's memory accesses.
struct HandsFixture {
  Device& device = plainDevice();
};

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "two hands run under validation, with edits and a restart") {
  const Scene scene = makeScene("sphere", 10'000);
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius, .friction = kFriction, .tools = std::vector<ToolShape>(2), .brush = kPush});
  std::span<const Contact> answers;
  for (int i = 0; i < 30; ++i) {
    const double r = 53 - 0.2 * i;
    answers = ask(touch, kTick_s * i, {0, 0, r}, {r, 0, 0});
    REQUIRE(answers[0].valid);
    REQUIRE(answers[1].valid);
  }
  CHECK(answers[1].touching);
  CHECK(answers[1].proxy.x == near(50, 3e-3));
  CHECK(touch.report().firstEdit_s);
  touch.resetHand(1);
  answers = ask(touch, 1, {0, 0, 47}, {47, 0, 0});
  CHECK(answers[0].touching);
  CHECK_FALSE(answers[1].touching);
  touch.finish();
}

TEST_CASE_FIXTURE(GpuFixture, "four hands with tools run under validation, with edits and restarts") {
  const Scene scene = makeScene("sphere", 10'000);
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius,
                   .friction = kFriction,
                   .tools = {ToolShape(), makeTool(ToolKind::pad, 6, 8), ToolShape(), makeTool(ToolKind::ball, 5, 6)},
                   .brush = kPush});
  for (int i = 0; i < 30; ++i) {
    const double r = 53 - 0.2 * i, time_s = kTick_s * i;
    const std::array poses{Pose{.time_s = time_s, .hip = {0, 0, r}}, Pose{.time_s = time_s, .hip = {0, 0, -r}},
                           Pose{.time_s = time_s, .hip = {r, 0, 0}}, Pose{.time_s = time_s, .hip = {0, r, 0}}};
    for (const Contact& contact : touch.query(poses, 0)) REQUIRE(contact.valid);
    if (i == 20)
      for (std::size_t hand = 1; hand < poses.size(); ++hand) touch.resetHand(hand);
  }
  CHECK(touch.report().firstEdit_s);
  touch.finish();
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

}  // namespace palpate::gpu_hands_test
