#include "haptics/clutch.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/haptics/device_doubles.hpp"
#include "tests/near.hpp"

namespace palpate::clutch_test {
namespace {

/// A floor at y = 1, felt from 0.02 s on; records whether the hand sculpts.
class Floor final : public OneHandQuery {
 public:
  Contact answerTo(const Pose& pose, double) noexcept override {
    sculpts.push_back(pose.sculpts);
    const double depth = pose.time_s < 0.02 ? 0 : 1;
    return {.proxy = pose.hip + DVec3(0, depth, 0),
            .normal = {0, 1, 0},
            .touching = depth > 0,
            .fresh = true,
            .valid = true};
  }
  std::vector<bool> sculpts;
};

}  // namespace

TEST_CASE("the HIP stays while clutched and continues from there without a jump") {
  Clutch clutch({.scale = 2, .offset = {1, 0, 0}});
  CHECK(clutch.toModel({1, 0, 0}, false) == DVec3(3, 0, 0));
  CHECK(clutch.toModel({2, 0, 0}, true) == DVec3(5, 0, 0));
  CHECK(clutch.toModel({7, 1, 0}, true) == DVec3(5, 0, 0));
  CHECK(clutch.isDrawn());
  CHECK(clutch.toModel({7, 1, 0}, false) == DVec3(5, 0, 0));
  CHECK(clutch.toModel({8, 1, 0}, false) == DVec3(7, 0, 0));
  CHECK_FALSE(clutch.isDrawn());
}

TEST_CASE("a gain scales the motion of the hand about where the HIP is, also while clutched") {
  Clutch clutch({.scale = 2, .offset = {1, 0, 0}}, 0.5);
  CHECK(clutch.toModel({1, 0, 0}, false) == DVec3(2, 0, 0));
  clutch.setGain(0.25, {1, 0, 0});
  CHECK(clutch.scale() == 0.5);
  CHECK(clutch.toModel({1, 0, 0}, false) == DVec3(2, 0, 0));
  CHECK(clutch.toModel({3, 2, 0}, false) == DVec3(3, 1, 0));
  CHECK(clutch.toModel({3, 2, 0}, true) == DVec3(3, 1, 0));
  clutch.setGain(1, {4, 0, 0});  // the hand moved while clutched
  CHECK(clutch.toModel({4, 0, 0}, true) == DVec3(3, 1, 0));
  CHECK(clutch.toModel({4, 0, 0}, false) == DVec3(3, 1, 0));
  CHECK(clutch.toModel({5, 0, 0}, false) == DVec3(5, 1, 0));
}

TEST_CASE("a stylus's buttons clutch and sculpt, and force that could not be rendered ramps up again") {
  // It moves to the right at 100 mm/s.
  ScriptedDevice device(
      [](double time_s) -> DeviceState {
        const bool clutched = time_s >= 0.1 - 1e-9 && time_s < 0.2 - 1e-9, sculpts = time_s >= 0.25 - 1e-9;
        return {.position = {100 * time_s, 0, 0},
                .buttons = (clutched ? kClutchButton : 0u) | (sculpts ? kSculptButton : 0u),
                .rendersForce = !(time_s > 0.2999 && time_s < 0.3001),
                .ok = true};
      },
      {.buttons = 2});
  Floor floor;
  ServoLoop loop(device, floor, ForceLaw({.stiffness_N_per_mm = 0.09, .damping_N_s_per_mm = 0}, {}),
                 {.duration_s = 0.35}, {.passivity = PassivityMode::off});
  const Trace trace = loop.run().trace();
  REQUIRE(trace.rows.size() == 350);
  CHECK(trace.rows[99].hip.x == near(9.9, 1e-6));
  CHECK(trace.rows[99].force_N.y > 0);
  for (int i = 100; i < 200; ++i) {
    CHECK(trace.rows[i].hip.x == near(10, 1e-6));
    CHECK(trace.rows[i].force_N == DVec3(0));
  }
  CHECK(trace.rows[200].hip.x == near(10, 1e-6));
  CHECK(trace.rows[249].hip.x == near(14.9, 1e-6));
  for (int i = 0; i < 350; ++i) CHECK(floor.sculpts[i] == (i >= 250));
  CHECK(trace.rows[299].force_N.y > 0);
  CHECK(trace.rows[300].force_N == DVec3(0));
  CHECK(trace.rows[301].force_N.y < 0.1 * trace.rows[299].force_N.y);
  CHECK(trace.rows[349].force_N.y > trace.rows[301].force_N.y);
}

namespace {

/// A floor at y = 0.
class Ground final : public OneHandQuery {
 public:
  Contact answerTo(const Pose& pose, double) noexcept override {
    const bool touches = pose.hip.y < 0;
    return {.proxy = touches ? DVec3(pose.hip.x, 0, pose.hip.z) : pose.hip,
            .normal = {0, 1, 0},
            .touching = touches,
            .fresh = true,
            .valid = true};
  }
};

}  // namespace

TEST_CASE("a gain that changes in contact moves neither the stylus nor the force, and bounds the stiffness") {
  // Down to 2 mm below the floor, and from 1.3 s on another 2 mm.
  const auto depth_mm = [](double t) { return std::min(2.0, 40 * t - 2) + std::clamp(20 * (t - 1.3), 0.0, 2.0); };
  for (const double gain : {0.05, 0.25, 1.0, 4.0}) {
    CAPTURE(gain);
    ScriptedDevice device(
        [&](double time_s) -> DeviceState {
          return {.position = {0, -depth_mm(time_s), 0}, .ok = true};
        },
        {.peakForce_N = 3, .mostStiffness_N_per_mm = 0.6});
    Ground ground;
    ForceOptions force{.stiffness_N_per_mm = 0.4, .damping_N_s_per_mm = 0};
    ServoLoop loop(device, ground, ForceLaw(force, {}), {.duration_s = 1.8}, {.passivity = PassivityMode::off});
    int tick = 0;
    const Trace trace = loop.run([&](const TraceRow&) {
                              if (++tick != 1200) return;
                              force.handGain = gain;
                              loop.setForce(force);
                            })
                            .trace();
    REQUIRE(trace.rows.size() == 1800);
    const auto& rows = trace.rows;
    CHECK(rows[1199].hip.y == near(-2, 1e-9));
    CHECK(rows[1199].force_N.y == near(0.8, 1e-6));
    for (int i = 1200; i < 1300; ++i) {
      CHECK(rows[i].hip.y == near(-2, 1e-9));
      CHECK(rows[i].force_N.y <= 0.8 + 1e-9);
      if (gain <= 1) CHECK(rows[i].force_N.y == near(0.8, 1e-6));
    }
    // From there on the stylus moves by the gain, and the force is bounded.
    CHECK(rows[1799].hip.y == near(-2 - 2 * gain, 1e-6));
    const double stiffness = std::min(0.4, 0.6 / std::max(1.0, gain));
    CHECK(rows[1799].force_N.y == near(std::min(3.0, stiffness * (2 + 2 * gain)), 1e-3));
    for (int i = 1; i < 1800; ++i) CHECK(std::abs(rows[i].force_N.y - rows[i - 1].force_N.y) <= 0.6 + 1e-9);
  }
}

TEST_CASE("a script says where the stylus is, whatever the gain of the hand") {
  ScriptedDevice device(
      [](double time_s) -> DeviceState {
        return {.position = {100 * time_s, 0, 0}, .ok = true};
      },
      {.handHeld = false});
  Ground ground;
  ServoLoop loop(device, ground, ForceLaw({.handGain = 0.25}, {}), {.duration_s = 0.1});
  CHECK(loop.run().trace().rows[50].hip.x == near(5, 1e-9));
}

TEST_CASE("a device without buttons sculpts whenever it touches") {
  ScriptedDevice device([](double) -> DeviceState { return {.ok = true}; });
  Floor floor;
  ServoLoop loop(device, floor, ForceLaw({}, {}), {.duration_s = 0.01});
  loop.run();
  for (const bool sculpts : floor.sculpts) CHECK(sculpts);
}

}  // namespace palpate::clutch_test
