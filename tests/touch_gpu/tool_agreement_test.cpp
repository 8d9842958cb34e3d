// Tools of many points: the GPU compared with double precision, and with one point.
#include <algorithm>

#include "tests/labels.hpp"
#include "tests/touch/tool_hands.hpp"

namespace palpate::tool_agreement_test {

namespace {

ToolShape onePoint() { return {.points = {ToolPoint{}}}; }

/// Both wander over the same surface, in and out of it, and rotate meanwhile.
void compareBackends(Device& device, std::string_view name, ToolKind kind, std::size_t points, std::size_t ticks,
                     std::size_t stride = 1, const DVec3& center = DVec3(0)) {
  CAPTURE(name);
  CAPTURE(static_cast<int>(kind));
  const Scene scene = makeScene(name, 10'000, center);
  const ToolShape tool = makeTool(kind, points, 8);
  GpuHand gpu(device, scene.cloud, TouchOptions{.radius = scene.radius, .friction = kFriction, .tools = {tool}});
  CpuHand cpu(scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tools = {tool}});
  std::size_t touched = 0, disagreed = 0;
  double worst_N = 0, worst_mNm = 0, largest_mNm = 0;
  const auto path = wanderingPath(scene, ticks, 0.5 * scene.radius, 2);
  for (std::size_t tick = 0; tick < ticks; tick += stride) {
    const DVec3& hip = path[tick];
    const DQuat turn = turnedAbout({0.3, 1, 0.2}, 0.02 * static_cast<double>(tick + 1));
    const Felt a = gpu.feel(hip, turn), b = cpu.feel(hip, turn);
    REQUIRE(a.contact.valid);
    REQUIRE(b.contact.valid);
    touched += b.contact.touching;
    for (std::size_t i = 0; i < points; ++i)
      disagreed += gpu.backend().points(0)[i].contact.touching != cpu.backend().points(0)[i].contact.touching;
    worst_N = std::max(worst_N, glm::distance(a.force_N, b.force_N));
    worst_mNm = std::max(worst_mNm, glm::distance(a.torque_mNm, b.torque_mNm));
    largest_mNm = std::max(largest_mNm, glm::length(b.torque_mNm));
  }
  CHECK(touched > ticks / stride / 4);
  CHECK(largest_mNm > 0.1);
  CHECK(disagreed == 0);
  CHECK(worst_N < 1e-3);
  CHECK(worst_mNm < 1e-3);
  gpu.backend().finish();
}

}  // namespace

TEST_CASE_FIXTURE(ToolFixture,
                  "GPU and double precision agree for every tool on every surface, rotated and with friction" *
                      kMoreInFull) {
  const std::size_t stride = byTier(3, 1), ball = byTier(13, 64), other = byTier(7, 16);
  for (const std::string_view name : {"sphere", "plane", "cube", "bumpy-sphere"})
    for (const ToolKind kind : kManyPointed)
      compareBackends(device, name, kind, kind == ToolKind::ball ? ball : other, 70, stride);
}

TEST_CASE_FIXTURE(ToolFixture, "GPU and double precision agree for every tool far from the origin") {
  compareBackends(device, "torus", ToolKind::pad, 16, 60, 2, {1e6, -2e6, 3e6});
}

TEST_CASE_FIXTURE(GpuFixture, "tools run under validation, and agree with double precision") {
  compareBackends(device, "sphere", ToolKind::pad, kMaxToolPoints, 50, 2);
}

TEST_CASE_FIXTURE(ToolFixture, "a tool of one point feels what the point feels alone, bit by bit") {
  const Scene scene = makeScene("bumpy-sphere", 10'000);
  TouchSide alone(device, scene.cloud, {.radius = scene.radius, .friction = kFriction});
  TouchSide tool(device, scene.cloud, {.radius = scene.radius, .friction = kFriction, .tools = {onePoint()}});
  CHECK(alone.points(0).empty());
  std::size_t touched = 0;
  double time_s = 0;
  for (const DVec3& hip : wanderingPath(scene, 150, 0.5 * scene.radius, 3)) {
    const Pose pose{.time_s = time_s += kTick_s, .hip = hip};
    const Contact a = alone.query(pose, 0), b = tool.query(pose, 0);
    REQUIRE(tool.points(0).size() == 1);
    const Contact& point = tool.points(0)[0].contact;
    touched += a.touching;
    CHECK(point.proxy == a.proxy);
    CHECK(point.normal == a.normal);
    CHECK(point.touching == a.touching);
    CHECK(point.neighbours == a.neighbours);
    CHECK(glm::distance(b.proxy, a.proxy) < 1e-12);
    CHECK(glm::distance(b.normal, a.normal) < 1e-6);
    CHECK(b.touching == a.touching);
    CHECK(b.neighbours == a.neighbours);
  }
  CHECK(touched > 30);
}

TEST_CASE_FIXTURE(GpuFixture, "in a cloud so dense that patches overflow a tool has room for each of its points") {
  Scene scene = makeScene("sphere", 20'000);
  scene.radius = 12 * scene.spacing;
  const ToolShape ball = makeTool(ToolKind::ball, 24, 8);
  GpuHand gpu(device, scene.cloud, TouchOptions{.radius = scene.radius, .friction = kFriction, .tools = {ball}});
  CpuHand cpu(scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tools = {ball}});
  std::size_t touched = 0;
  double worst_N = 0;
  for (const DVec3& hip : wanderingPath(scene, 25, 0.2 * scene.radius, 4)) {
    const Felt a = gpu.feel(hip), b = cpu.feel(hip);
    CHECK(b.contact.neighbours > shared::kMaxSharedPatch / 4);
    touched += b.contact.touching;
    worst_N = std::max(worst_N, glm::distance(a.force_N, b.force_N));
  }
  CHECK(touched > 5);
  CHECK(worst_N < 1e-3);
}

}  // namespace palpate::tool_agreement_test
