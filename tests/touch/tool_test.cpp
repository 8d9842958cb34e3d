// Tools of many points: the GPU against double precision, what they feel on surfaces that are known, and where they
// end.
#include <algorithm>
#include <numbers>

#include "engine/core/error.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "haptics/force_law.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/busy.hpp"

namespace palpate {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity(), kTick_s = 1e-3;
// Without limits and without damping: the force of a pose is that of its depth.
constexpr ForceOptions kSpring{
    .stiffness_N_per_mm = 0.8, .damping_N_s_per_mm = 0, .maxForce_N = kInfinite, .maxRise_N_per_s = kInfinite};

DQuat turnedAbout(const DVec3& axis, double angle) {
  return {std::cos(0.5 * angle), std::sin(0.5 * angle) * glm::normalize(axis)};
}

// A software driver takes many seconds to compile a step for validation: the tests of what its shader does to memory
// have that, and all others share one device without it, and one step with friction.
constexpr double kFriction = 0.3;
class ToolFixture {
 protected:
  Device& device = shared();

 private:
  static Device& shared() {
    static Device device({.gpu = "", .validate = false});
    return device;
  }
};

struct Felt {
  Contact contact;
  DVec3 force_N{0}, torque_mNm{0};
};

/// A back end with a force law behind it; model units are mm.
template <class Backend>
class Hand {
 public:
  template <class... Args>
  explicit Hand(Args&&... args) : backend_(std::forward<Args>(args)...), law_(kSpring, {}) {
    law_.feelWith(backend_.points().size());
  }
  Felt feel(const DVec3& hip, const DQuat& turn = {1, 0, 0, 0}, double budget_us = 0) {
    const Pose pose{.time_s = time_s_ += kTick_s, .hip = hip, .turn = turn};
    Felt felt{.contact = backend_.query(pose, budget_us)};
    felt.force_N = backend_.points().empty() ? law_.update(felt.contact, pose, kTick_s)
                                             : law_.update(felt.contact, backend_.points(), pose, kTick_s);
    felt.torque_mNm = law_.torque_mNm();
    return felt;
  }
  /// Straight down from 8 above, in steps of 0.25.
  Felt press(double depth, const DQuat& turn = {1, 0, 0, 0}) {
    Felt felt;
    for (double z = 8; z > -depth; z -= 0.25) felt = feel({0.3, 0.2, z}, turn);
    return feel({0.3, 0.2, -depth}, turn);
  }
  Backend& backend() { return backend_; }

 private:
  Backend backend_;
  ForceLaw law_;
  double time_s_ = 0;
};
using GpuHand = Hand<TouchSide>;
using CpuHand = Hand<CpuTouch>;

constexpr std::array<ToolKind, 3> kManyPointed{ToolKind::pad, ToolKind::ball, ToolKind::spatula};

ToolShape onePoint() { return {.points = {ToolPoint{}}}; }

double secondMoment(const ToolShape& tool) {
  double sum = 0;
  for (const ToolPoint& point : tool.points) sum += point.share * point.place.y * point.place.y;
  return sum;
}

/// What each back end has to feel, on its own instance.
template <class Check>
void onBoth(Device& device, const Scene& scene, const ToolShape& tool, Check&& check) {
  {
    CAPTURE("gpu");
    GpuHand hand(device, scene.cloud, TouchOptions{.radius = scene.radius, .friction = kFriction, .tool = tool});
    check(hand);
  }
  {
    CAPTURE("cpu");
    CpuHand hand(scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tool = tool});
    check(hand);
  }
}

/// Both wander over the same surface, in and out of it, and turn as they go.
void compareBackends(Device& device, std::string_view name, ToolKind kind, std::size_t points, std::size_t ticks,
                     const DVec3& center = DVec3(0)) {
  CAPTURE(name);
  CAPTURE(static_cast<int>(kind));
  const Scene scene = makeScene(name, 10'000, center);
  const ToolShape tool = makeTool(kind, points, 8);
  GpuHand gpu(device, scene.cloud, TouchOptions{.radius = scene.radius, .friction = kFriction, .tool = tool});
  CpuHand cpu(scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tool = tool});
  std::size_t touched = 0, disagreed = 0;
  double worst_N = 0, worst_mNm = 0, largest_mNm = 0;
  int tick = 0;
  for (const DVec3& hip : wanderingPath(scene, ticks, 0.5 * scene.radius, 2)) {
    ++tick;
    const DQuat turn = turnedAbout({0.3, 1, 0.2}, 0.02 * tick);
    const Felt a = gpu.feel(hip, turn), b = cpu.feel(hip, turn);
    REQUIRE(a.contact.valid);
    REQUIRE(b.contact.valid);
    touched += b.contact.touching;
    for (std::size_t i = 0; i < points; ++i)
      disagreed += gpu.backend().points()[i].contact.touching != cpu.backend().points()[i].contact.touching;
    worst_N = std::max(worst_N, glm::distance(a.force_N, b.force_N));
    worst_mNm = std::max(worst_mNm, glm::distance(a.torque_mNm, b.torque_mNm));
    largest_mNm = std::max(largest_mNm, glm::length(b.torque_mNm));
  }
  CHECK(touched > ticks / 4);
  CHECK(largest_mNm > 0.1);
  CHECK(disagreed == 0);
  CHECK(worst_N < 1e-3);
  CHECK(worst_mNm < 1e-3);
  gpu.backend().finish();
}

}  // namespace

TEST_CASE_FIXTURE(ToolFixture, "GPU and double precision feel every tool alike, on every surface, turned and rubbing") {
  for (const std::string_view name : {"sphere", "plane", "cube", "bumpy-sphere"})
    for (const ToolKind kind : kManyPointed) compareBackends(device, name, kind, kind == ToolKind::ball ? 64 : 16, 70);
}

TEST_CASE_FIXTURE(ToolFixture, "they do far from the origin") {
  compareBackends(device, "torus", ToolKind::pad, 16, 60, {1e6, -2e6, 3e6});
}

TEST_CASE_FIXTURE(GpuFixture, "they do under validation") {
  compareBackends(device, "sphere", ToolKind::pad, kMostToolPoints, 50);
}

TEST_CASE_FIXTURE(ToolFixture, "one point answered as a tool feels what it feels alone, bit by bit") {
  const Scene scene = makeScene("bumpy-sphere", 10'000);
  TouchSide alone(device, scene.cloud, {.radius = scene.radius, .friction = kFriction});
  TouchSide tool(device, scene.cloud, {.radius = scene.radius, .friction = kFriction, .tool = onePoint()});
  CHECK(alone.points().empty());
  std::size_t touched = 0;
  double time_s = 0;
  for (const DVec3& hip : wanderingPath(scene, 150, 0.5 * scene.radius, 3)) {
    const Pose pose{.time_s = time_s += kTick_s, .hip = hip};
    const Contact a = alone.query(pose, 0), b = tool.query(pose, 0);
    REQUIRE(tool.points().size() == 1);
    const Contact& point = tool.points()[0].contact;
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

TEST_CASE_FIXTURE(ToolFixture,
                  "a tool pressed flat on a plane is as stiff as one point at its mean depth, and does not turn") {
  const Scene scene = makeScene("plane", 20'000);
  for (const ToolKind kind : kManyPointed)
    for (const std::size_t count : {2u, 15u, 64u}) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(count);
      const ToolShape tool = makeTool(kind, count, 8);
      constexpr double kDepth = 6;  // all points are below
      double mean = 0, sum = 0;
      for (const ToolPoint& point : tool.points) mean += point.share * (kDepth - point.place.z);
      for (const ToolPoint& point : tool.points) sum += point.share * (kDepth - point.place.z) * point.place.y;
      onBoth(device, scene, tool, [&](auto& hand) {
        const Felt felt = hand.press(kDepth);
        CHECK(hand.backend().points().size() == count);
        CHECK(felt.contact.neighbours > 10);
        CHECK(felt.contact.normal.z == doctest::Approx(1));
        CHECK(glm::distance(felt.force_N, {0, 0, kSpring.stiffness_N_per_mm * mean}) < 1e-4);
        CHECK(glm::distance(felt.contact.proxy, {0.3, 0.2, -kDepth + mean}) < 1e-4);
        // A ball of few points is a little out of balance.
        const double off_mNm = kind == ToolKind::ball ? kSpring.stiffness_N_per_mm * std::abs(sum) : 0;
        CHECK(std::abs(felt.torque_mNm.x) == doctest::Approx(off_mNm).epsilon(1e-3));
        if (kind != ToolKind::ball) CHECK(glm::length(felt.torque_mNm) < 1e-4);
      });
    }
  onBoth(device, scene, {}, [&](auto& hand) {
    CHECK(glm::distance(hand.press(6).force_N, {0, 0, 6 * kSpring.stiffness_N_per_mm}) < 1e-4);
  });
}

TEST_CASE_FIXTURE(ToolFixture, "a tool that stands askew is turned flat, by its depths times its levers") {
  const Scene scene = makeScene("plane", 20'000);
  const ToolShape spatula = makeTool(ToolKind::spatula, 15, 8);
  constexpr double kDepth = 3;
  for (const double tilt : {0.3, -0.3, 0.1}) {
    CAPTURE(tilt);
    const double expected_mNm = -kSpring.stiffness_N_per_mm * std::sin(tilt) * std::cos(tilt) * secondMoment(spatula);
    onBoth(device, scene, spatula, [&](auto& hand) {
      const Felt felt = hand.press(kDepth, turnedAbout({1, 0, 0}, tilt));
      CHECK(felt.torque_mNm.x == doctest::Approx(expected_mNm).scale(0).epsilon(1e-3));
      CHECK(std::abs(felt.torque_mNm.y) < 1e-4);
      CHECK(std::abs(felt.torque_mNm.z) < 1e-4);
      CHECK(felt.force_N.z == doctest::Approx(kSpring.stiffness_N_per_mm * kDepth).scale(0).epsilon(1e-4));
    });
  }
}

TEST_CASE_FIXTURE(ToolFixture, "a ball that is twisted on a plane is held back by the friction at each of its points") {
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
    // No more than the friction of all the force at the rim of the contact, 4 mm away from the middle.
    const double most_mNm = kFriction * 1.25 * there.force_N.z * 4;
    CHECK(there.torque_mNm.z < -0.1 * most_mNm);
    CHECK(there.torque_mNm.z > -most_mNm);
    CHECK(back.torque_mNm.z > 0.1 * most_mNm);
  });
  CpuHand smooth(scene.cloud, CpuTouchOptions{.radius = scene.radius, .tool = ball});
  smooth.press(-3);
  const Felt felt = twist(smooth, 0, 0.4);
  CHECK(felt.force_N.z > 0.1);
  CHECK(std::abs(felt.torque_mNm.z) < 1e-4);
}

TEST_CASE_FIXTURE(ToolFixture, "in free space a tool feels exactly nothing, wherever it is turned") {
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

TEST_CASE_FIXTURE(GpuFixture, "clouds without a surface have none for a tool either") {
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
                  "a turn that is none is a fault at that pose alone, and so is a place past all numbers") {
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

TEST_CASE_FIXTURE(ToolFixture, "a stylus that is put down elsewhere holds no point of its tool any more") {
  const Scene scene = makeScene("plane", 5'000);
  onBoth(device, scene, makeTool(ToolKind::pad, 12, 8), [&](auto& hand) {
    CHECK(hand.press(3).contact.touching);
    hand.backend().beginAnew();
    for (const PointContact& point : hand.backend().points()) CHECK_FALSE(point.contact.touching);
    // Put down inside, it is not caught until it has been outside.
    CHECK_FALSE(hand.feel({5, 5, -2}).contact.touching);
    CHECK(hand.press(3).contact.touching);
  });
}

TEST_CASE_FIXTURE(ToolFixture, "what a brush does under a tool is what it does under its HIP alone, bit by bit") {
  const Scene scene = makeScene("sphere", 10'000);
  const BrushOptions push{.tau = 0.3, .beta = 0.2, .toolRadius = 8};
  std::vector<PointCloud> sculpted;
  for (const ToolShape& tool : {ToolShape{}, makeTool(ToolKind::pad, 8, 8)}) {
    TouchSide touch(device, scene.cloud, {.radius = scene.radius, .friction = kFriction, .tool = tool, .brush = push});
    for (int i = 0; i <= 60; ++i)
      touch.query({.time_s = kTick_s * i, .hip = {0, 0, 51 - 4 * std::min(1.0, i / 40.0)}}, 0);
    touch.finish();
    sculpted.push_back(scene.cloud);
    CHECK(touch.readBack(sculpted.back()) > 30);
  }
  CHECK(sculpted[0].positions == sculpted[1].positions);
  CHECK(sculpted[0].normals == sculpted[1].normals);
}

TEST_CASE("a tool feels what was edited under it as one that comes new to the cloud does") {
  const Scene scene = makeScene("sphere", 10'000);
  const ToolShape pad = makeTool(ToolKind::pad, 12, 8);
  const auto options = [&](std::optional<BrushOptions> brush) {
    return CpuTouchOptions{.radius = scene.radius, .tool = pad, .brush = brush};
  };
  CpuHand sculptor(scene.cloud, options(BrushOptions{.tau = 0.3, .beta = 1, .toolRadius = 8}));
  for (int i = 0; i <= 80; ++i) sculptor.feel({0, 0, 52 - 4 * std::min(1.0, i / 40.0)});
  sculptor.backend().finish();
  PointCloud dented = scene.cloud;
  REQUIRE(sculptor.backend().readBack(dented) > 15);
  sculptor.backend().setBrush(std::nullopt);
  CpuHand fresh(dented, options({}));
  for (double z = 60; z > 47; z -= 0.2) {
    const Felt a = sculptor.feel({0, 0, z}), b = fresh.feel({0, 0, z});
    if (z > 58) continue;  // once it has let go
    CHECK(glm::distance(a.force_N, b.force_N) < 1e-6);
  }
}

TEST_CASE_FIXTURE(ToolFixture, "the patch bridges late answers for each point that it reaches, as the GPU would") {
  const Scene scene = makeScene("sphere", 20'000);
  const ToolShape tool = makeTool(ToolKind::ball, 12, 2);
  GpuHand gpu(device, scene.cloud,
              TouchOptions{.radius = scene.radius, .friction = kFriction, .tool = tool, .wait = Wait::block});
  CpuHand cpu(scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tool = tool});
  const auto place = [&](double along, double r) {
    const double angle = along * scene.radius / 50;
    return r * DVec3(std::sin(angle), 0, std::cos(angle));
  };
  for (const double r : {52.9, 52.6, 52.3, 51.9, 51.4, 50.7, 50.0}) {  // brings a patch, and a contact
    CHECK(gpu.feel(place(0, r), {1, 0, 0, 0}, 1e7).contact.fresh);
    cpu.feel(place(0, r));
  }
  const auto busy = std::make_unique<Busy>(device, 400);
  // From there it rubs and twists over the patch, lets go, and touches again.
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
      disagreed += gpu.backend().points()[k].contact.touching != cpu.backend().points()[k].contact.touching;
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
  // The GPU goes on from where each point has come to, friction included.
  const Felt after = gpu.feel(hip, turn), truth = cpu.feel(hip, turn);
  CHECK(after.contact.fresh);
  CHECK(glm::distance(after.force_N, truth.force_N) < 1e-3);
  CHECK(glm::distance(after.torque_mNm, truth.torque_mNm) < 1e-3);
  gpu.backend().finish();
}

TEST_CASE_FIXTURE(
    ToolFixture, "a tool whose answer is late keeps the planes that its points felt past the patch, ever more softly") {
  const Scene scene = makeScene("plane", 20'000);
  const ToolShape spatula = makeTool(ToolKind::spatula, 8, 40);  // all of them 7 and more from the HIP
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius, .friction = kFriction, .tool = spatula, .wait = Wait::block});
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
  // It is deeper now, and each point stands where the turn has brought it.
  CHECK(held.proxy.z == doctest::Approx(0).epsilon(1e-3));
  double deepest = 0, shallowest = 10;
  for (const PointContact& point : touch.points()) {
    deepest = std::max(deepest, point.contact.proxy.z - point.hip.z);
    shallowest = std::min(shallowest, point.contact.proxy.z - point.hip.z);
  }
  CHECK(deepest - shallowest == doctest::Approx(40 * 0.75 * std::sin(0.02)).scale(0).epsilon(0.01));
  held = late(0.0125, -1.5);
  CHECK(held.proxy.z == doctest::Approx(-0.75).scale(0).epsilon(1e-2));
  held = late(0.021, -1.5);
  CHECK_FALSE(held.touching);
  CHECK(held.valid);
  CHECK(touch.query({.time_s = time_s + 0.022, .hip = {0, 0, -1.5}}, 0).fresh);
  touch.finish();
}

TEST_CASE_FIXTURE(ToolFixture,
                  "a tool is asked by the fused method alone, ahead like one point, and goes on after a change") {
  const Scene scene = makeScene("sphere", 5'000);
  const ToolShape pad = makeTool(ToolKind::pad, 8, 8);
  for (const QueryMethod method : {QueryMethod::brute, QueryMethod::indirect, QueryMethod::naive, QueryMethod::twoStep})
    CHECK_THROWS_WITH_AS(TouchSide(device, scene.cloud, {.radius = scene.radius, .method = method, .tool = pad}),
                         doctest::Contains("fused"), UsageError);
  ToolShape half = pad;
  half.points.resize(4);
  CHECK_THROWS_WITH_AS(TouchSide(device, scene.cloud, {.radius = scene.radius, .tool = half}),
                       doctest::Contains("stiffness"), UsageError);

  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .friction = kFriction, .tool = pad, .ahead = true});
  CHECK(touch.asksAhead());
  CHECK_THROWS_AS(touch.setContact(SurfaceKind::sphere, 0, QueryMethod::indirect), UsageError);
  touch.setContact(SurfaceKind::average, kFriction, QueryMethod::fused);
  Contact contact;
  for (double z = 52; z > 48; z -= 0.2) contact = touch.query({.hip = {0, 0, z}}, 0);
  CHECK(contact.touching);
  CHECK(touch.asksAhead());
  CHECK(touch.points().size() == 8);
}

TEST_CASE_FIXTURE(GpuFixture, "a tool in a cloud so dense that patches spill has room for each of its points") {
  Scene scene = makeScene("sphere", 20'000);
  scene.radius = 12 * scene.spacing;
  const ToolShape ball = makeTool(ToolKind::ball, 24, 8);
  GpuHand gpu(device, scene.cloud, TouchOptions{.radius = scene.radius, .friction = kFriction, .tool = ball});
  CpuHand cpu(scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tool = ball});
  std::size_t touched = 0;
  double worst_N = 0;
  for (const DVec3& hip : wanderingPath(scene, 25, 0.2 * scene.radius, 4)) {
    const Felt a = gpu.feel(hip), b = cpu.feel(hip);
    CHECK(b.contact.neighbours > shared::kSharedPatch / 4);
    touched += b.contact.touching;
    worst_N = std::max(worst_N, glm::distance(a.force_N, b.force_N));
  }
  CHECK(touched > 5);
  CHECK(worst_N < 1e-3);
}

}  // namespace palpate
