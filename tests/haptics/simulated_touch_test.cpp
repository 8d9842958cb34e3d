#include "haptics/devices/simulated_touch.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "engine/core/error.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/near.hpp"

namespace palpate::simulated_touch_test {
namespace {

const DVec3 kRight(1, 0, 0);
constexpr SimulatedTouchOptions kNoHand{.handStiffness_N_per_mm = 0, .handDamping_N_s_per_mm = 0};

SimulatedTouch resting(const SimulatedTouchOptions& options = kNoHand) {
  return SimulatedTouch(Path({{0, DVec3(0)}}), {}, options);
}

/// Ticks of 1 ms under a constant force; returns the final position of the stylus.
double pushed(SimulatedTouch& touch, double force_N, int from, int to) {
  for (int i = from; i < to; ++i) {
    touch.read(1e-3 * i);
    touch.write(force_N * kRight);
  }
  touch.read(1e-3 * to);
  return touch.position_mm().x;
}

}  // namespace

TEST_CASE("friction holds against a weaker force without the smallest motion") {
  SimulatedTouch touch = resting();
  CHECK(pushed(touch, 0.259, 0, 1000) == 0);
  CHECK(pushed(touch, 0.30, 1000, 2000) > 1);
}

TEST_CASE("a free mass is accelerated by the force minus friction, up to the limit of viscosity") {
  SimulatedTouch touch = resting();
  // 1 N minus 0.26 N on 45 g over the 19 ms of force; viscosity reduces it by a tenth.
  const double exact_mm = 0.5 * (0.74 / 0.045) * 1e3 * 0.019 * 0.019;
  CHECK(pushed(touch, 1, 0, 20) == near(exact_mm, 0.12));
  const SimulatedTouchOptions thick{
      .handStiffness_N_per_mm = 0, .handDamping_N_s_per_mm = 0, .viscosity_N_s_per_mm = 0.01};
  SimulatedTouch slow = resting(thick);
  const double before_mm = pushed(slow, 1, 0, 400);
  CHECK(pushed(slow, 1, 400, 500) - before_mm == near(0.1 * 0.74 / 0.01, 0.001));
}

TEST_CASE("a force acts one tick after it is written and lasts until the next") {
  SimulatedTouch touch = resting();
  touch.read(0);
  touch.write(3.0 * kRight);
  touch.read(0.001);
  touch.write(DVec3(0));
  CHECK(touch.position_mm().x == 0);
  touch.read(0.002);
  const double after_mm = touch.position_mm().x;
  CHECK(after_mm == near(0.5 * (2.74 / 0.045) * 1e3 * 1e-6, 0.1));
}

TEST_CASE("friction brings a moving stylus to rest and holds it there") {
  SimulatedTouch touch = resting();
  pushed(touch, 2, 0, 10);
  const double stopped_mm = pushed(touch, 0, 10, 1000);
  CHECK(pushed(touch, 0, 1000, 2000) == stopped_mm);
}

TEST_CASE("positions are whole encoder steps") {
  SimulatedTouch touch(Path({{0, DVec3(0)}, {1, {7, -5, 3}}}), {});
  for (int i = 0; i < 1000; ++i) {
    const DVec3 steps = touch.read(1e-3 * i).position / 0.055;
    for (int k = 0; k < 3; ++k) REQUIRE(steps[k] == within(std::round(steps[k]), 1e-6));
  }
  CHECK(touch.position_mm().x > 5);
}

TEST_CASE("the simulated hand follows its intention within what friction holds") {
  SimulatedTouch touch(Path({{0, DVec3(0)}, {0.4, {10, 0, 0}}}), {});
  for (int i = 0; i <= 1000; ++i) touch.read(1e-3 * i);
  CHECK(std::abs(touch.position_mm().x - 10) <= 0.26 / 0.4 + 1e-9);
}

TEST_CASE("the amplifiers saturate at the peak, and a force that is not a number becomes zero") {
  SimulatedTouch strong = resting(), stronger = resting();
  CHECK(pushed(strong, 3.3, 0, 30) == near(pushed(stronger, 1e6, 0, 30), 1e-6));
  SimulatedTouch touch = resting();
  touch.read(0);
  CHECK_FALSE(touch.write({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
  touch.read(0.1);
  CHECK(touch.position_mm() == DVec3(0));
}

TEST_CASE("after an emergency stop no force moves the simulated stylus") {
  SimulatedTouch touch = resting();
  touch.emergencyStop();
  CHECK(pushed(touch, 3, 0, 100) == 0);
}

TEST_CASE("the workspace of the simulated stylus has ends") {
  SimulatedTouch touch(Path({{0, DVec3(0)}, {1, {500, 500, -500}}}), {});
  for (int i = 0; i <= 2000; ++i) touch.read(1e-3 * i);
  CHECK(touch.position_mm() == DVec3(80, 60, -35));
  SimulatedTouch outside(Path({{0, {500, 0, 0}}}), {});
  CHECK(std::abs(outside.read(0).position.x - 80) < 0.055);
}

TEST_CASE("the same reads and writes give the same positions, and an earlier time restarts") {
  SimulatedTouch touch(Path({{0, DVec3(0)}, {0.2, {9, 2, 1}}}), {});
  std::vector<DVec3> first;
  for (int run = 0; run < 2; ++run)
    for (int i = 0; i < 300; ++i) {
      touch.read(1e-3 * i);
      touch.write({0, 0.01 * (i % 7), 0});
      if (run == 0)
        first.push_back(touch.position_mm());
      else
        REQUIRE(touch.position_mm() == first[static_cast<std::size_t>(i)]);
    }
}

TEST_CASE("lost ticks and slow rates change the simulated physics little") {
  SimulatedTouch fine(Path({{0, DVec3(0)}, {0.2, {9, 2, 1}}}), {}), coarse(Path({{0, DVec3(0)}, {0.2, {9, 2, 1}}}), {});
  for (int i = 0; i <= 3000; ++i) fine.read(1e-4 * i);
  for (int i = 0; i <= 30; ++i) coarse.read(1e-2 * i);
  CHECK(glm::distance(fine.position_mm(), coarse.position_mm()) < 0.05);
}

TEST_CASE("a path keeps its scale in the workspace if it fits, and is shrunk otherwise") {
  const ModelScale scale{10};
  const WorkspaceMap small = workspaceAround(Path({{0, {100, 0, 0}}, {1, {102, 4, 1}}}), scale);
  CHECK(small.scale == near(0.1, 1e-6));
  CHECK(small.toModel(DVec3(0)) == DVec3(101, 2, 0.5));
  const WorkspaceMap large = workspaceAround(Path({{0, DVec3(0)}, {1, {10, 4, 12.6}}}), scale);
  CHECK(large.scale == near(0.2, 1e-6));  // 12.6 units in 63 mm
}

TEST_CASE("in a session the simulated hand presses a sphere and feels it, with the same trace each time") {
  std::vector<TraceRow> first;
  for (int run = 0; run < 2; ++run) {
    const Path path({{0, {0, 0, 53}}, {0.2, {0, 0, 48}}, {0.6, {0, 0, 48}}});
    SimulatedTouch device(path, workspaceAround(path, {}), {.lead_s = 0.5});
    SphereContact sphere(50);
    ServoLoop loop(device, sphere, ForceLaw({}, {}), {.duration_s = device.duration_s()},
                   {.map = workspaceAround(path, {})});
    const ServoResult result = loop.run();
    REQUIRE(result.trace().rows.size() == 1100);
    CHECK(glm::distance(result.trace().rows.front().hip, DVec3(0, 0, 53)) < 0.055);
    const TraceRow& last = result.trace().rows.back();
    // At rest the springs of the surface and the hand, and friction, are in balance.
    CHECK(last.force_N.z == near(0.8 * last.penetration_mm, 1e-6));
    CHECK(std::abs(last.force_N.z - 0.4 * (2 - last.penetration_mm)) <= 0.26 + 0.03);
    CHECK(last.force_N.z > 0.3);
    REQUIRE(result.counts().leastEnergy_mJ);
    CHECK(*result.counts().leastEnergy_mJ > -0.1);
    if (run == 0) first = result.trace().rows;
    for (std::size_t i = 0; i < first.size(); ++i) REQUIRE(first[i].force_N == result.trace().rows[i].force_N);
  }
}

TEST_CASE("a hand that presses a sphere and withdraws at 1 m/s gets no energy that it has not put in") {
  for (const double speed_mm_per_s : {100.0, 300.0, 1000.0})
    for (const double depth_mm : {3.0, 5.0, 8.0})
      for (const double aside_mm : {0.0, 12.0}) {
        CAPTURE(speed_mm_per_s);
        CAPTURE(depth_mm);
        CAPTURE(aside_mm);
        const double way_s = std::hypot(15, aside_mm) / speed_mm_per_s;
        const Path path({{0, {0, 0, 65 - depth_mm}},
                         {way_s, {aside_mm, 0, 50 - depth_mm}},
                         {2 * way_s, {2 * aside_mm, 0, 65 - depth_mm}},
                         {2 * way_s + 0.1, {2 * aside_mm, 0, 65 - depth_mm}}});
        SimulatedTouch device(path, workspaceAround(path, {}), {.lead_s = 0.6});
        SphereContact sphere(50);
        ServoLoop loop(device, sphere, ForceLaw({}, {}), {.duration_s = device.duration_s()},
                       {.map = workspaceAround(path, {}), .passivity = PassivityMode::on});
        const ServoResult result = loop.run();
        CHECK(summarize(result.trace()).peakForce_N > 0.03);
        REQUIRE(result.counts().leastEnergy_mJ);
        CHECK(*result.counts().leastEnergy_mJ > -0.15);
      }
}

TEST_CASE("a simulated hand with parameters out of range is refused") {
  const auto made = [](const SimulatedTouchOptions& options) { return resting(options).name(); };
  CHECK_NOTHROW(made({}));
  CHECK_THROWS_AS(made({.handStiffness_N_per_mm = -1}), UsageError);
  CHECK_THROWS_AS(made({.handDamping_N_s_per_mm = std::numeric_limits<double>::infinity()}), UsageError);
  CHECK_THROWS_AS(made({.mass_kg = 0}), UsageError);
  CHECK_THROWS_AS(made({.friction_N = std::numeric_limits<double>::quiet_NaN()}), UsageError);
  CHECK_THROWS_AS(made({.encoderStep_mm = 0}), UsageError);
  CHECK_THROWS_AS(SimulatedTouch(Path({{0, DVec3(0)}}), {.scale = 0}), UsageError);
}

}  // namespace palpate::simulated_touch_test
