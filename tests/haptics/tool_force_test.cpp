// The force law and the servo loop with a tool of many points.
#include <doctest/doctest.h>

#include <array>

#include "haptics/devices/path_device.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/content_of.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::tool_force_test {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr ForceOptions kPlainSpring{
    .stiffness_N_per_mm = 0.5, .damping_N_s_per_mm = 0, .maxForce_N = kInfinite, .maxRise_N_per_s = kInfinite};
constexpr double kTick_s = 1e-3;

const Contact kTouching{.normal = {0, 0, 1}, .touching = true, .fresh = true, .valid = true};

DVec3 forceOf(ForceLaw& law, std::span<const PointContact> points, const Contact& whole = kTouching) {
  law.feelWith(points.size());
  return law.update(whole, points, {}, kTick_s);
}

const Path kPress({{0, {0, 0, 1}}, {0.1, {0, 0, -1}}, {0.2, {0, 0, 1}}});

}  // namespace

TEST_CASE("the forces of a tool's points are summed by their shares, and give a torque about the HIP in N mm") {
  ForceLaw law(kPlainSpring, {.mm_per_unit = 2});
  const std::array points{pressedPoint({3, 0, 0}, 1, 0.25), pressedPoint({0, 1, 0}, 2, 0.5),
                          pressedPoint({9, 9, 9}, 0, 0.25)};
  const DVec3 force_N = forceOf(law, points);
  // 0.5 N/mm times 2 mm a unit: 0.25 N at x = 6 mm and 1 N at y = 2 mm.
  CHECK(glm::distance(force_N, {0, 0, 1.25}) < 1e-12);
  CHECK(glm::distance(law.torque_mNm(), {2, -1.5, 0}) < 1e-12);
  CHECK(law.demand_N() == near(1.25, 1e-6));
}

TEST_CASE("a tool of one point at the HIP has the force of the single-point law, bit for bit, tick by tick") {
  const ForceOptions options{.stiffness_N_per_mm = 0.7, .damping_N_s_per_mm = 0.003, .maxForce_N = 0.6};
  ForceLaw alone(options, {.mm_per_unit = 1.3}), tool(options, {.mm_per_unit = 1.3});
  tool.feelWith(1);
  for (int i = 0; i < 200; ++i) {
    const double depth = std::sin(0.07 * i) + 0.3 * std::sin(0.31 * i);
    const std::array points{pressedPoint({0.1 * i, 0, 0}, depth, 1, glm::normalize(DVec3(0.1, 0.2, 1)))};
    const Pose pose{.hip = points[0].hip};
    const Contact& contact = points[0].contact;
    CHECK(tool.update(contact, points, pose, kTick_s) == alone.update(contact, pose, kTick_s));
    CHECK(tool.demand_N() == alone.demand_N());
    CHECK(glm::length(tool.torque_mNm()) == 0);
  }
}

TEST_CASE("limits apply to the sum, and scale the torque equally") {
  ForceOptions options = kPlainSpring;
  options.maxForce_N = 1;
  ForceLaw law(options, {});
  const std::array points{pressedPoint({2, 0, 0}, 4, 0.5), pressedPoint({-1, 0, 0}, 4, 0.5)};
  CHECK(glm::distance(forceOf(law, points), {0, 0, 1}) < 1e-12);
  CHECK(law.demand_N() == near(2, 1e-6));
  CHECK(glm::distance(law.torque_mNm(), {0, -0.5, 0}) < 1e-12);

  options.maxForce_N = kInfinite;
  options.maxRise_N_per_s = 600;
  ForceLaw rising(options, {});
  CHECK(forceOf(rising, points).z == near(0.6, 1e-6));
  CHECK(rising.torque_mNm().y == near(-0.3, 1e-6));
}

TEST_CASE("a tool's point that would pull is left out, and the others are kept") {
  ForceOptions options = kPlainSpring;
  options.damping_N_s_per_mm = 0.01;
  ForceLaw law(options, {});
  forceOf(law, std::array{pressedPoint({2, 0, 0}, 1, 0.5), pressedPoint({-2, 0, 0}, 1, 0.5)});
  // The first point moves out at 100 mm/s, against 0.9 mm of spring.
  const DVec3 force_N = forceOf(law, std::array{pressedPoint({2, 0, 0}, 0.9, 0.5), pressedPoint({-2, 0, 0}, 1, 0.5)});
  CHECK(glm::distance(force_N, {0, 0, 0.25}) < 1e-12);
  CHECK(glm::distance(law.torque_mNm(), {0, 0.5, 0}) < 1e-12);
}

TEST_CASE("opposing forces rotate the tool without moving it") {
  ForceLaw law(kPlainSpring, {});
  const std::array points{pressedPoint({0, 3, 0}, 1, 0.5, {1, 0, 0}), pressedPoint({0, -3, 0}, 1, 0.5, {-1, 0, 0})};
  CHECK(forceOf(law, points) == DVec3(0));
  CHECK(glm::distance(law.torque_mNm(), {0, 0, -1.5}) < 1e-12);
}

TEST_CASE("a tool without contact, a fault, or a value that is not a number has no force and no torque") {
  const std::array good{pressedPoint({3, 0, 0}, 1, 0.5), pressedPoint({-3, 0, 0}, 2, 0.5)};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ForceLaw law(kPlainSpring, {});
  const auto isNothing = [&](std::span<const PointContact> points, const Contact& whole) {
    CHECK(glm::length(forceOf(law, good)) > 0);
    CHECK(forceOf(law, points, whole) == DVec3(0));
    CHECK(law.torque_mNm() == DVec3(0));
    CHECK(law.demand_N() == 0);
  };
  isNothing(good, {.valid = true});
  isNothing(good, {.touching = true});
  isNothing(std::array{pressedPoint({3, 0, 0}, 0, 0.5), pressedPoint({-3, 0, 0}, 0, 0.5)}, {.valid = true});
  isNothing(std::array{pressedPoint({nan, 0, 0}, 1, 0.5), pressedPoint({-3, 0, 0}, 2, 0.5)}, kTouching);
  isNothing(std::array{pressedPoint({3, 0, 0}, kInfinite, 0.5), pressedPoint({-3, 0, 0}, 2, 0.5)}, kTouching);
}

TEST_CASE("the servo loop traces a tool's torque with the force that was sent") {
  PathDevice device(kPress);
  HalfOverPlane query;
  ServoLoop loop(device, query, ForceLaw(kPlainSpring, {}), {.duration_s = 0.2});
  const Trace trace = loop.run().trace();
  CHECK(trace.torques);
  std::size_t touched = 0;
  for (const TraceRow& row : trace.rows) {
    const double depth = std::max(0.0, -row.hip.z);
    touched += depth > 0;
    if (depth == 0) CHECK(row.torque_mNm == DVec3(0));
    CHECK(row.force_N.z == within(0.25 * depth, 1e-9));
    CHECK(row.torque_mNm.y == within(-4 * row.force_N.z, 1e-9));
    CHECK(row.penetration_mm == within(0.5 * depth, 1e-9));
  }
  CHECK(touched > 90);
  CHECK(summarize(trace).peakTorque_mNm == near(1, 1e-6));

  const ScratchFolder folder;
  writeTraceCsv(folder / "trace.csv", trace);
  const std::string text = contentOf(folder / "trace.csv");
  CHECK(text.substr(0, text.find('\n')).ends_with(",step_us,torque_x,torque_y,torque_z"));
}

TEST_CASE("no torque remains if forces are off or answers fail") {
  PathDevice device(kPress);
  HalfOverPlane query;
  std::atomic<bool> on = true;
  ServoOptions options{.duration_s = 0.2};
  SUBCASE("off") {
    on = false;
    options.forcesOn = &on;
  }
  SUBCASE("failing") { query.failsFrom_s = 0; }
  ServoLoop loop(device, query, ForceLaw(kPlainSpring, {}), options);
  const ServoResult result = loop.run();
  for (const TraceRow& row : result.trace().rows) {
    CHECK(row.force_N == DVec3(0));
    CHECK(row.torque_mNm == DVec3(0));
  }
}

}  // namespace palpate::tool_force_test
