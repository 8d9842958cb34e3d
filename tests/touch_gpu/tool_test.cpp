// Tools of many points: what they feel on known surfaces, and their limits.
#include "engine/core/error.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/touch/tool_hands.hpp"

namespace palpate::tool_test {

namespace {

double secondMoment(const ToolShape& tool) {
  double sum = 0;
  for (const ToolPoint& point : tool.points) sum += point.share * point.place.y * point.place.y;
  return sum;
}

}  // namespace

TEST_CASE_FIXTURE(ToolFixture,
                  "a tool pressed flat on a plane has the stiffness of one point at its mean depth, without a torque" *
                      kMoreInFull) {
  const Scene scene = makeScene("plane", 20'000);
  for (const ToolKind kind : kManyPointed)
    for (const std::size_t count : byTier<std::vector<std::size_t>>({2, 15}, {2, 15, 64})) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(count);
      const ToolShape tool = makeTool(kind, count, 8);
      constexpr double kDepth = 6;  // all points are below the surface
      double mean = 0, sum = 0;
      for (const ToolPoint& point : tool.points) mean += point.share * (kDepth - point.place.z);
      for (const ToolPoint& point : tool.points) sum += point.share * (kDepth - point.place.z) * point.place.y;
      onBoth(device, scene, tool, [&](auto& hand) {
        const Felt felt = hand.press(kDepth);
        CHECK(hand.backend().points(0).size() == count);
        CHECK(felt.contact.neighbours > 10);
        CHECK(felt.contact.normal.z == near(1, 1e-5));
        CHECK(glm::distance(felt.force_N, {0, 0, kSpring.stiffness_N_per_mm * mean}) < 1e-4);
        CHECK(glm::distance(felt.contact.proxy, {0.3, 0.2, -kDepth + mean}) < 1e-4);
        // A ball of few points is slightly unbalanced.
        const double off_mNm = kind == ToolKind::ball ? kSpring.stiffness_N_per_mm * std::abs(sum) : 0;
        CHECK(std::abs(felt.torque_mNm.x) == within(off_mNm, 1e-3));
        if (kind != ToolKind::ball) CHECK(glm::length(felt.torque_mNm) < 1e-4);
      });
    }
  onBoth(device, scene, {}, [&](auto& hand) {
    CHECK(glm::distance(hand.press(6).force_N, {0, 0, 6 * kSpring.stiffness_N_per_mm}) < 1e-4);
  });
}

TEST_CASE_FIXTURE(ToolFixture, "a tilted tool is rotated flat, by its depths times its levers") {
  const Scene scene = makeScene("plane", 20'000);
  const ToolShape spatula = makeTool(ToolKind::spatula, 15, 8);
  constexpr double kDepth = 3;
  for (const double tilt : {0.3, -0.3, 0.1}) {
    CAPTURE(tilt);
    const double expected_mNm = -kSpring.stiffness_N_per_mm * std::sin(tilt) * std::cos(tilt) * secondMoment(spatula);
    onBoth(device, scene, spatula, [&](auto& hand) {
      const Felt felt = hand.press(kDepth, turnedAbout({1, 0, 0}, tilt));
      CHECK(felt.torque_mNm.x == near(expected_mNm, 1e-3));
      CHECK(std::abs(felt.torque_mNm.y) < 1e-4);
      CHECK(std::abs(felt.torque_mNm.z) < 1e-4);
      CHECK(felt.force_N.z == near(kSpring.stiffness_N_per_mm * kDepth, 1e-4));
    });
  }
}

TEST_CASE_FIXTURE(ToolFixture, "friction at each point of a ball resists its rotation on a plane") {
  const Scene scene = makeScene("plane", 20'000);
  const ToolShape ball = makeTool(ToolKind::ball, 64, 10);
  const auto twist = [](auto& hand, double from, double to) {
    Felt felt;
    for (int i = 0; i <= 20; ++i) felt = hand.feel({0.3, 0.2, 3}, turnedAbout({0, 0, 1}, glm::mix(from, to, i / 20.0)));
    return felt;
  };
  onBoth(device, scene, ball, [&](auto& hand) {
    hand.press(-3);  // 2 deep: 13 of 64 points touch
    const Felt there = twist(hand, 0, 0.4), back = twist(hand, 0.4, 0);
    // At most the friction of the whole force at the rim of the contact, 4 mm from the centre.
    const double most_mNm = kFriction * 1.25 * there.force_N.z * 4;
    CHECK(there.torque_mNm.z < -0.1 * most_mNm);
    CHECK(there.torque_mNm.z > -most_mNm);
    CHECK(back.torque_mNm.z > 0.1 * most_mNm);
  });
  CpuHand smooth(scene.cloud, CpuTouchOptions{.radius = scene.radius, .tools = {ball}});
  smooth.press(-3);
  const Felt felt = twist(smooth, 0, 0.4);
  CHECK(felt.force_N.z > 0.1);
  CHECK(std::abs(felt.torque_mNm.z) < 1e-4);
}

TEST_CASE_FIXTURE(ToolFixture, "in free space a tool feels exactly zero force, in any orientation") {
  const Scene scene = makeScene("torus", 5'000);
  onBoth(device, scene, makeTool(ToolKind::ball, 64, 6), [&](auto& hand) {
    for (int i = 0; i < 60; ++i) {
      const DVec3 hip = i < 30 ? DVec3(0.05 * i, 0.1, 0.2) : DVec3(0, 0, 100.0 - i);  // in the hole, and far above
      const Felt felt = hand.feel(hip, turnedAbout({1, 2, 3}, 0.3 * i));
      CHECK(felt.contact.valid);
      CHECK_FALSE(felt.contact.touching);
      CHECK(felt.contact.proxy == hip);
      CHECK(felt.force_N == DVec3(0));
      CHECK(felt.torque_mNm == DVec3(0));
    }
  });
}

TEST_CASE_FIXTURE(GpuFixture, "clouds without a surface give a tool no contact") {
  for (const std::size_t count : {0u, 1u}) {
    CAPTURE(count);
    Scene scene{.shape = nullptr, .cloud = {}, .spacing = 1, .radius = 4};
    scene.cloud.positions.assign(count, Vec3(0.3, 0.2, 0));
    scene.cloud.normals.assign(count, Vec3(0, 0, 1));
    onBoth(device, scene, makeTool(ToolKind::pad, 8, 8), [&](auto& hand) {
      const Felt felt = hand.press(2);
      CHECK(felt.contact.valid);
      CHECK_FALSE(felt.contact.touching);
      CHECK(felt.force_N == DVec3(0));
    });
  }
}

TEST_CASE_FIXTURE(ToolFixture,
                  "an invalid orientation, or a position that is not finite, is a fault at that pose only") {
  const Scene scene = makeScene("plane", 5'000);
  onBoth(device, scene, makeTool(ToolKind::spatula, 8, 8), [&](auto& hand) {
    const Felt before = hand.press(1);
    for (const DQuat bad : {DQuat(0, 0, 0, 0), DQuat(2, 0, 0, 0), DQuat(std::nan(""), 0, 0, 1)}) {
      const Felt felt = hand.feel({0.3, 0.2, -1}, bad);
      CHECK_FALSE(felt.contact.valid);
      CHECK_FALSE(felt.contact.lost);
      CHECK(felt.force_N == DVec3(0));
      CHECK(felt.torque_mNm == DVec3(0));
    }
    CHECK_FALSE(hand.feel({kInfinite, 0, 0}).contact.valid);
    CHECK(glm::distance(hand.feel({0.3, 0.2, -1}).force_N, before.force_N) < 1e-4);
  });
}

TEST_CASE_FIXTURE(ToolFixture, "after a stylus is put down elsewhere no point of its tool keeps a contact") {
  const Scene scene = makeScene("plane", 5'000);
  onBoth(device, scene, makeTool(ToolKind::pad, 12, 8), [&](auto& hand) {
    CHECK(hand.press(3).contact.touching);
    hand.backend().resetHand(0);
    for (const PointContact& point : hand.backend().points(0)) CHECK_FALSE(point.contact.touching);
    // Put down inside the surface, it is not caught until it has been outside.
    CHECK_FALSE(hand.feel({5, 5, -2}).contact.touching);
    CHECK(hand.press(3).contact.touching);
  });
}

TEST_CASE_FIXTURE(ToolFixture,
                  "a tool requires the fused method, is asked ahead like one point, and continues after a change") {
  const Scene scene = makeScene("sphere", 5'000);
  const ToolShape pad = makeTool(ToolKind::pad, 8, 8);
  for (const QueryMethod method : {QueryMethod::brute, QueryMethod::indirect, QueryMethod::naive, QueryMethod::twoStep})
    CHECK_THROWS_WITH_AS(TouchSide(device, scene.cloud, {.radius = scene.radius, .method = method, .tools = {pad}}),
                         doctest::Contains("fused"), UsageError);
  ToolShape half = pad;
  half.points.resize(4);
  CHECK_THROWS_WITH_AS(TouchSide(device, scene.cloud, {.radius = scene.radius, .tools = {half}}),
                       doctest::Contains("stiffness"), UsageError);

  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .friction = kFriction, .tools = {pad}, .ahead = true});
  CHECK(touch.asksAhead());
  CHECK_THROWS_AS(touch.setContact(SurfaceKind::sphere, 0, "indirect"), UsageError);
  touch.setContact(SurfaceKind::average, kFriction, "fused");
  Contact contact;
  for (double z = 52; z > 48; z -= 0.2) contact = touch.query({.hip = {0, 0, z}}, 0);
  CHECK(contact.touching);
  CHECK(touch.asksAhead());
  CHECK(touch.points(0).size() == 8);
}

}  // namespace palpate::tool_test
