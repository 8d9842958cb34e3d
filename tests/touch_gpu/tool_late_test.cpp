// Tools of many points whose answers are late.
#include <algorithm>

#include "tests/near.hpp"
#include "tests/touch/busy.hpp"
#include "tests/touch/tool_hands.hpp"

namespace palpate::tool_late_test {

TEST_CASE_FIXTURE(ToolFixture,
                  "the patch bridges late answers for each tool point in its range, as the GPU would answer") {
  const Scene scene = makeScene("sphere", 20'000);
  const ToolShape tool = makeTool(ToolKind::ball, 12, 2);
  GpuHand gpu(device, scene.cloud,
              TouchOptions{.radius = scene.radius, .friction = kFriction, .tools = {tool}, .wait = Wait::block});
  CpuHand cpu(scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tools = {tool}});
  const auto place = [&](double along, double r) {
    const double angle = along * scene.radius / 50;
    return r * DVec3(std::sin(angle), 0, std::cos(angle));
  };
  for (const double r : {52.9, 52.6, 52.3, 51.9, 51.4, 50.7, 50.0}) {  // receives a patch, and a contact
    CHECK(gpu.feel(place(0, r), {1, 0, 0, 0}, 1e7).contact.fresh);
    cpu.feel(place(0, r));
  }
  const auto busy = std::make_unique<Busy>(device, 400);
  // From there it slides and twists over the patch, lets go, and touches again.
  std::size_t touched = 0, disagreed = 0;
  double worst_N = 0, worst_mNm = 0, largest_mNm = 0;
  DQuat turn(1, 0, 0, 0);
  DVec3 hip;
  for (int i = 0; i <= 80; ++i) {
    hip = place(0.6 * std::sin(0.02 * i), 50.2 - 1.2 * std::cos(0.1 * i + 1.4));
    turn = turnedAbout({0, 0, 1}, 0.01 * i);
    const Felt late = gpu.feel(hip, turn, 1), truth = cpu.feel(hip, turn);
    CHECK_FALSE(late.contact.fresh);
    CHECK(late.contact.valid);
    touched += truth.contact.touching;
    for (std::size_t k = 0; k < tool.points.size(); ++k)
      disagreed += gpu.backend().points(0)[k].contact.touching != cpu.backend().points(0)[k].contact.touching;
    worst_N = std::max(worst_N, glm::distance(late.force_N, truth.force_N));
    worst_mNm = std::max(worst_mNm, glm::distance(late.torque_mNm, truth.torque_mNm));
    largest_mNm = std::max(largest_mNm, glm::length(truth.torque_mNm));
  }
  CHECK(touched > 20);
  CHECK(touched < 80);
  CHECK(disagreed == 0);
  CHECK(largest_mNm > 0.02);
  CHECK(worst_N < 1e-3);
  CHECK(worst_mNm < 1e-3);
  // The GPU continues from the CPU's proxy of each point, friction included.
  const Felt after = gpu.feel(hip, turn), truth = cpu.feel(hip, turn);
  CHECK(after.contact.fresh);
  CHECK(glm::distance(after.force_N, truth.force_N) < 1e-3);
  CHECK(glm::distance(after.torque_mNm, truth.torque_mNm) < 1e-3);
  gpu.backend().finish();
}

TEST_CASE_FIXTURE(ToolFixture, "a tool with a late answer keeps its points' planes beyond the patch, and fades out") {
  const Scene scene = makeScene("plane", 20'000);
  const ToolShape spatula = makeTool(ToolKind::spatula, 8, 40);  // every point at least 7 from the HIP
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius, .friction = kFriction, .tools = {spatula}, .wait = Wait::block});
  double time_s = 0;
  Contact felt;
  for (double z = 2; z > -1; z -= 0.25) felt = touch.query({.time_s = time_s += kTick_s, .hip = {0, 0, z}}, 1e7);
  REQUIRE(felt.fresh);
  REQUIRE(felt.touching);
  const Busy busy(device, 200);
  const auto late = [&](double age_s, double z, const DQuat& turn = {1, 0, 0, 0}) {
    return touch.query({.time_s = time_s + age_s, .hip = {0, 0, z}, .turn = turn}, 1);
  };
  Contact held = late(0.002, -1.5, turnedAbout({1, 0, 0}, 0.02));
  CHECK_FALSE(held.fresh);
  CHECK(held.valid);
  CHECK(held.touching);
  // It is deeper now, and each point is where the rotation moved it.
  CHECK(held.proxy.z == within(0, 1e-3));
  double deepest = 0, shallowest = 10;
  for (const PointContact& point : touch.points(0)) {
    deepest = std::max(deepest, point.contact.proxy.z - point.hip.z);
    shallowest = std::min(shallowest, point.contact.proxy.z - point.hip.z);
  }
  CHECK(deepest - shallowest == near(40 * 0.75 * std::sin(0.02), 0.01));
  held = late(0.0125, -1.5);
  CHECK(held.proxy.z == near(-0.75, 1e-2));
  held = late(0.021, -1.5);
  CHECK_FALSE(held.touching);
  CHECK(held.valid);
  CHECK(touch.query({.time_s = time_s + 0.022, .hip = {0, 0, -1.5}}, 0).fresh);
  touch.finish();
}

}  // namespace palpate::tool_late_test
