// Four hands on one cloud, each with a tool of its own, on both back ends: each is answered as if it were alone.
#include <array>

#include "engine/core/error.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/scenes.hpp"

namespace palpate::four_hands_test {

namespace {

constexpr std::size_t kHands = 4;
constexpr double kTick_s = 1e-3, kFriction = 0.3;

using Poses = std::array<Pose, kHands>;

/// The HIP alone, a pad, the HIP alone, a ball.
std::vector<ToolShape> tools() {
  return {ToolShape(), makeTool(ToolKind::pad, 6, 8), ToolShape(), makeTool(ToolKind::ball, 5, 6)};
}

/// One hand at each of four positions, all at the same height over the plane.
Poses overPlane(double time_s, double z) {
  Poses poses;
  for (std::size_t i = 0; i < kHands; ++i)
    poses[i] = {.time_s = time_s, .hip = {i % 2 ? 6.0 : -6.0, i < 2 ? 6.1 : -6.1, z}};
  return poses;
}

/// One device for all tests, without validation.
class FourHandsFixture {
 protected:
  Device& device = plainDevice();
  std::unique_ptr<TouchBackend> make(bool onGpu, const Scene& scene, const std::vector<ToolShape>& tools) {
    if (onGpu)
      return std::make_unique<TouchSide>(device, scene.cloud,
                                         TouchOptions{.radius = scene.radius, .friction = kFriction, .tools = tools});
    return std::make_unique<CpuTouch>(
        scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tools = tools, .threads = 1});
  }
};

bool equal(const Contact& a, const Contact& b) {
  return a.valid && b.valid && a.fresh && b.fresh && a.proxy == b.proxy && a.normal == b.normal &&
         a.touching == b.touching && a.neighbours == b.neighbours;
}

bool equal(std::span<const PointContact> a, std::span<const PointContact> b) {
  return std::ranges::equal(a, b, [](const PointContact& left, const PointContact& right) {
    return left.hip == right.hip && left.share == right.share && equal(left.contact, right.contact);
  });
}

}  // namespace

TEST_CASE_FIXTURE(FourHandsFixture,
                  "each of four hands is answered as if alone, bit by bit, with any tool" * kMoreInFull) {
  const std::size_t ticks = byTier<std::size_t>(45, 120);
  for (const bool onGpu : {false, true})
    for (const std::string_view name : {"bumpy-sphere", "cube"}) {
      CAPTURE(onGpu);
      CAPTURE(name);
      const Scene scene = makeScene(name, 5'000);
      const auto together = make(onGpu, scene, tools());
      REQUIRE(together->hands() == kHands);
      std::array<std::unique_ptr<TouchBackend>, kHands> alone;
      std::array<std::vector<DVec3>, kHands> ways;
      for (std::size_t i = 0; i < kHands; ++i) {
        alone[i] = make(onGpu, scene, {tools()[i]});
        ways[i] = wanderingPath(scene, ticks, 0.5 * scene.radius, static_cast<std::uint32_t>(2 + 7 * i));
      }
      std::array<std::size_t, kHands> touched{}, different{};
      for (std::size_t tick = 0; tick < ticks; ++tick) {
        Poses poses;
        for (std::size_t i = 0; i < kHands; ++i)
          poses[i] = {.time_s = kTick_s * static_cast<double>(tick), .hip = ways[i][tick]};
        const auto answers = together->ask(poses, 0);
        REQUIRE(answers.size() == kHands);
        for (std::size_t i = 0; i < kHands; ++i) {
          const Contact own = alone[i]->query(poses[i], 0);
          touched[i] += own.touching;
          different[i] += !equal(answers[i], own) || !equal(together->points(i), alone[i]->points(0));
        }
        together->prepare();
      }
      for (std::size_t i = 0; i < kHands; ++i) {
        CAPTURE(i);
        CHECK(touched[i] > ticks / 12);
        CHECK(different[i] == 0);
      }
    }
}

TEST_CASE_FIXTURE(FourHandsFixture, "one of four hands is put down elsewhere, and the others continue") {
  const Scene scene = makeScene("plane", 10'000);
  for (const bool onGpu : {false, true})
    for (std::size_t lifted = 0; lifted < kHands; ++lifted) {
      CAPTURE(onGpu);
      CAPTURE(lifted);
      const auto touch = make(onGpu, scene, std::vector<ToolShape>(kHands));
      const auto at = [&](double z) { return touch->ask(overPlane(0, z), 0); };
      std::span<const Contact> answers;
      for (double z = 4; z > -2; z -= 0.25) answers = at(z);
      for (const Contact& contact : answers) CHECK(contact.touching);
      touch->resetHand(lifted);
      answers = at(-2);
      // Put down inside the surface, it is not caught until it has been outside.
      for (std::size_t i = 0; i < kHands; ++i) CHECK(answers[i].touching == (i != lifted));
      at(4);
      answers = at(-1);
      for (const Contact& contact : answers) CHECK(contact.touching);
    }
}

TEST_CASE_FIXTURE(FourHandsFixture,
                  "a position of one of four hands that is not finite is a fault for all, at that pose only") {
  const Scene scene = makeScene("plane", 5'000);
  for (const bool onGpu : {false, true})
    for (std::size_t bad = 0; bad < kHands; ++bad) {
      CAPTURE(onGpu);
      CAPTURE(bad);
      const auto touch = make(onGpu, scene, std::vector<ToolShape>(kHands));
      Poses poses = overPlane(0, 3);
      poses[bad].hip.y = std::nan("");
      for (const Contact& contact : touch->ask(poses, 0)) {
        CHECK_FALSE(contact.valid);
        CHECK_FALSE(contact.lost);
      }
      std::span<const Contact> answers;
      for (double z = 3; z > -1; z -= 0.25) answers = touch->ask(overPlane(0, z), 0);
      for (const Contact& contact : answers) CHECK(contact.touching);
    }
}

TEST_CASE_FIXTURE(GpuFixture, "four hands with tools run under validation, with edits and restarts") {
  const Scene scene = makeScene("sphere", 10'000);
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius,
                   .friction = kFriction,
                   .tools = tools(),
                   .brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.5, .radius = 8}});
  for (int i = 0; i < 30; ++i) {
    const double r = 53 - 0.2 * i, time_s = kTick_s * i;
    const Poses poses{Pose{.time_s = time_s, .hip = {0, 0, r}}, Pose{.time_s = time_s, .hip = {0, 0, -r}},
                      Pose{.time_s = time_s, .hip = {r, 0, 0}}, Pose{.time_s = time_s, .hip = {0, r, 0}}};
    for (const Contact& contact : touch.ask(poses, 0)) REQUIRE(contact.valid);
    touch.prepare();
    if (i == 20)
      for (std::size_t hand = 1; hand < kHands; ++hand) touch.resetHand(hand);
  }
  CHECK(touch.report().firstEdit_s);
  touch.finish();
}

TEST_CASE_FIXTURE(FourHandsFixture, "the number of hands is at least one and at most a maximum") {
  const Scene scene = makeScene("plane", 1'000);
  for (const bool onGpu : {false, true}) {
    CAPTURE(onGpu);
    CHECK(make(onGpu, scene, std::vector<ToolShape>(kMaxHands))->hands() == kMaxHands);
    for (const std::size_t hands : {std::size_t{0}, kMaxHands + 1})
      CHECK_THROWS_WITH_AS(make(onGpu, scene, std::vector<ToolShape>(hands)), doctest::Contains("must be 1 to 8"),
                           UsageError);
  }
}

}  // namespace palpate::four_hands_test
