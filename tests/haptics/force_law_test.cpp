#include "haptics/force_law.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "engine/core/error.hpp"
#include "tests/near.hpp"

namespace palpate::force_law_test {
namespace {

constexpr double kTick_s = 0.001;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const ForceOptions kSpringOnly{.damping_N_s_per_mm = 0, .maxRise_N_per_s = kInfinity};

/// The plane z = 0, with the HIP below it.
Pose below(double depth) { return {.hip = {1, 2, -depth}}; }
Contact onPlane(const Pose& pose) {
  return {.proxy = {pose.hip.x, pose.hip.y, 0}, .normal = {0, 0, 1}, .touching = true, .fresh = true, .valid = true};
}
double pushed_N(ForceLaw& law, double depth) { return law.update(onPlane(below(depth)), below(depth), kTick_s).z; }

}  // namespace

TEST_CASE("the spring pushes along the normal with stiffness times depth in millimetres") {
  ForceLaw law(kSpringOnly, ModelScale{10});
  const DVec3 force_N = law.update(onPlane(below(0.2)), below(0.2), kTick_s);
  CHECK(force_N.x == 0);
  CHECK(force_N.y == 0);
  CHECK(force_N.z == near(0.8 * 2, 1e-6));
}

TEST_CASE("the force is exactly zero without contact and at a fault") {
  ForceLaw law({}, ModelScale{});
  const Pose pose = below(1);
  Contact contact = onPlane(pose);
  SUBCASE("not touching") { contact.touching = false; }
  SUBCASE("not valid") { contact.valid = false; }
  SUBCASE("the proxy is not a number") { contact.proxy.y = kNaN; }
  SUBCASE("the proxy is infinite") { contact.proxy.z = kInfinity; }
  SUBCASE("the proxy is so far away that its square overflows") { contact.proxy.z = 1e200; }
  SUBCASE("the normal is not a number") { contact.normal.x = kNaN; }
  SUBCASE("the normal is missing") { contact.normal = DVec3(0); }
  CHECK(law.update(contact, pose, kTick_s) == DVec3(0));
}

TEST_CASE("a damper brakes hand and surface motion, and not the jump to another frame of a moving surface") {
  ForceLaw law({.maxRise_N_per_s = kInfinity}, ModelScale{1});
  const Pose pose = below(3);
  const auto at = [&](double aside_mm, double velocity_mm_s) {
    Contact contact = onPlane(pose);
    contact.proxy.x += aside_mm;
    contact.velocity = {0, 0, velocity_mm_s};
    return law.update(contact, pose, kTick_s);
  };
  at(0, 5);
  // The hand rests: the surface approaches at 5 mm/s, and the frame's jump does not count as 300 mm/s.
  const DVec3 leapt_N = at(0.3, 5);
  CHECK(glm::distance(leapt_N, 0.8 * DVec3(0.3, 0, 3)) <= 0.002 * 5 * (1 + 1e-9));
  // Without a known surface velocity, a jump of the proxy counts as motion of the hand.
  law.reset();
  at(0, 0);
  CHECK(at(0.3, 0).x == near(0.8 * 0.3 + 0.002 * 300, 1e-6));
}

TEST_CASE(
    "a surface that is lost under a loaded hand lets the force fall slowly, and a withdrawing hand is free at once") {
  ForceLaw law({.damping_N_s_per_mm = 0}, ModelScale{1});
  const auto free = [](const Pose& pose) { return Contact{.proxy = pose.hip, .fresh = true, .valid = true}; };
  for (int i = 0; i < 10; ++i) pushed_N(law, 3);
  double last_N = 2.4;
  SUBCASE("the hand rests, and is free after 40 ms") {
    for (int i = 1; i < 40; ++i) {
      const DVec3 force_N = law.update(free(below(3)), below(3), kTick_s);
      CHECK(force_N.z == near(last_N - 0.06, 1e-9));
      last_N = force_N.z;
    }
    CHECK(last_N == near(0.06, 1e-6));
    law.update(free(below(3)), below(3), kTick_s);
    CHECK(law.update(free(below(3)), below(3), kTick_s) == DVec3(0));
  }
  SUBCASE("it withdraws from there, and the force falls as a spring relaxes") {
    double work_mJ = 0;
    for (double depth = 3; last_N > 0; depth -= 1) {
      const DVec3 force_N = law.update(free(below(depth - 1)), below(depth - 1), kTick_s);
      CHECK(force_N.z == within(std::max(0.0, last_N - 0.8 - 0.06), 1e-9));
      work_mJ += last_N * 1;
      last_N = force_N.z;
    }
    CHECK(work_mJ < 2.4 * 2.4 / (2 * 0.8) + 2.4);  // and a tick of the force before it is withdrawn
  }
  SUBCASE("it comes out by itself") {
    CHECK(pushed_N(law, 0.9) == near(0.72, 1e-6));
    CHECK(law.update(free(below(-0.1)), below(-0.1), kTick_s) == DVec3(0));
  }
  SUBCASE("a fault") { CHECK(law.update({.proxy = below(3).hip}, below(3), kTick_s) == DVec3(0)); }
}

TEST_CASE("a pose or time that is not a number gives no force, and the next valid tick starts again from zero") {
  ForceLaw law({}, ModelScale{});
  pushed_N(law, 1);
  Pose broken = below(1);
  SUBCASE("pose") {
    broken.hip.x = kNaN;
    CHECK(law.update(onPlane(below(1)), broken, kTick_s) == DVec3(0));
  }
  SUBCASE("time") { CHECK(law.update(onPlane(broken), broken, kNaN) == DVec3(0)); }
  CHECK(pushed_N(law, 1) == near(0.6, 1e-6));  // the slew limit starts at zero again
}

TEST_CASE("the force is clamped in magnitude and keeps its direction") {
  ForceLaw law({.damping_N_s_per_mm = 0, .maxForce_N = 2, .maxRise_N_per_s = kInfinity}, ModelScale{});
  const Pose pose{.hip = {-30, 0, -40}};
  Contact contact = onPlane(pose);
  contact.proxy = DVec3(0);
  const DVec3 force_N = law.update(contact, pose, kTick_s);
  CHECK(glm::length(force_N) == near(2, 1e-6));
  CHECK(force_N.x / force_N.z == near(0.75, 1e-6));
  law.limitTo(0.5);
  CHECK(glm::length(law.update(contact, pose, kTick_s)) == near(0.5, 1e-6));
  law.limitTo(kNaN);
  CHECK(law.update(contact, pose, kTick_s) == DVec3(0));
}

TEST_CASE("the force rises no faster than the slew limit and falls at once") {
  ForceLaw law({.damping_N_s_per_mm = 0, .maxRise_N_per_s = 100}, ModelScale{});
  for (int tick = 1; tick <= 8; ++tick) CHECK(pushed_N(law, 1) == near(std::min(0.1 * tick, 0.8), 1e-6));
  CHECK(pushed_N(law, 0.1) == near(0.08, 1e-6));
  CHECK(pushed_N(law, 1) == near(0.18, 1e-6));
}

TEST_CASE("a surface that moves alone raises and lowers the force a tenth as fast as the hand may") {
  ForceLaw law({.damping_N_s_per_mm = 0}, ModelScale{});
  const Pose pose = below(1);
  const auto raised_N = [&](double height) {
    Contact contact = onPlane(pose);
    contact.proxy.z = height;
    return law.update(contact, pose, kTick_s).z;
  };
  raised_N(0);
  CHECK(raised_N(0) == near(0.8, 1e-6));
  for (int i = 1; i <= 5; ++i) CHECK(raised_N(3) == near(0.8 + 0.06 * i, 1e-6));
  for (int i = 4; i >= -3; --i) CHECK(raised_N(-0.5) == near(0.8 + 0.06 * i, 1e-6));
  // The hand withdraws, and is free at once.
  CHECK(law.update({.proxy = {1, 2, 1}, .valid = true}, {.hip = {1, 2, 1}}, kTick_s) == DVec3(0));
}

TEST_CASE("a late tick does not catch up in one jump of the force") {
  ForceLaw law({.damping_N_s_per_mm = 0, .maxRise_N_per_s = 100}, ModelScale{});
  CHECK(law.update(onPlane(below(4)), below(4), 1.0).z == near(0.2, 1e-6));
  CHECK(law.update(onPlane(below(4)), below(4), 0).z == near(0.2, 1e-6));
  CHECK(law.update(onPlane(below(4)), below(4), -1).z == near(0.2, 1e-6));
}

TEST_CASE("damping resists motion and starts at the second tick of contact") {
  ForceLaw law({.maxRise_N_per_s = kInfinity}, ModelScale{});
  CHECK(pushed_N(law, 1) == near(0.8, 1e-6));
  CHECK(pushed_N(law, 1.05) == near(0.8 * 1.05 + 0.002 * 50, 1e-6));
  CHECK(pushed_N(law, 1) == near(0.8 - 0.002 * 50, 1e-6));
  law.update({.valid = true}, below(-1), kTick_s);
  CHECK(pushed_N(law, 1) == near(0.8, 1e-6));
}

TEST_CASE("encoder steps at 10 kHz do not become force jumps") {
  constexpr double kFast_s = 1e-4, kStep_mm = 0.055, kSpeed_mm_per_s = 20;
  ForceLaw law({}, ModelScale{});
  double least = 1e9, most = -1e9, sum = 0;
  int count = 0;
  for (int i = 0; i < 1000; ++i) {
    const double depth_mm = 3 - kSpeed_mm_per_s * kFast_s * i;  // moving out
    const Pose pose = below(kStep_mm * std::round(depth_mm / kStep_mm));
    const double excess_N = law.update(onPlane(pose), pose, kFast_s).z - (0.8 * depth_mm - 0.002 * kSpeed_mm_per_s);
    if (i < 100) continue;  // the force is still rising
    least = std::min(least, excess_N);
    most = std::max(most, excess_N);
    sum += excess_N;
    ++count;
  }
  CHECK(std::abs(sum / count) < 0.06);
  CHECK(most - least < 0.2);
}

TEST_CASE("the damper never pulls into the surface") {
  ForceLaw law({.maxRise_N_per_s = kInfinity}, ModelScale{});
  pushed_N(law, 1);
  const Pose sideways{.hip = {5, 2, -0.01}};
  CHECK(law.update(onPlane(sideways), sideways, kTick_s) == DVec3(0));
}

TEST_CASE("force options out of range are refused") {
  CHECK_THROWS_AS(ForceLaw({.stiffness_N_per_mm = -1}, {}), UsageError);
  CHECK_THROWS_AS(ForceLaw({.stiffness_N_per_mm = kInfinity}, {}), UsageError);
  CHECK_THROWS_AS(ForceLaw({.damping_N_s_per_mm = kNaN}, {}), UsageError);
  CHECK_THROWS_AS(ForceLaw({.maxForce_N = kNaN}, {}), UsageError);
  CHECK_THROWS_AS(ForceLaw({.maxRise_N_per_s = -600}, {}), UsageError);
}

TEST_CASE("a surface changes the direction of a force no faster than its size") {
  ForceLaw law({.stiffness_N_per_mm = 1, .damping_N_s_per_mm = 0, .maxForce_N = 3, .maxRise_N_per_s = 500}, {1});
  const auto pushed = [&](const DVec3& normal) {
    return law.update({.proxy = 2.0 * normal, .normal = normal, .touching = true, .fresh = true, .valid = true}, {},
                      0.001);
  };
  DVec3 last(0);
  for (int i = 0; i < 10; ++i) last = pushed({0, 0, 1});
  CHECK(last.z == near(2, 1e-6));
  // The surface rotates by a right angle between two ticks.
  int ticks = 0;
  while (glm::distance(last, DVec3(2, 0, 0)) > 1e-9 && ++ticks < 100) {
    const DVec3 next = pushed({1, 0, 0});
    CHECK(glm::distance(next, last) <= 0.05 + 1e-12);
    CHECK(glm::length(next) <= 2 + 1e-12);
    last = next;
  }
  CHECK(ticks > 55);
  CHECK(ticks < 70);
}

TEST_CASE("the power of a moving surface on the hand is limited, and other forces are unchanged") {
  ForceOptions options = kSpringOnly;
  options.maxSurfacePower_W = 0.5;
  const auto felt_N = [&](const DVec3& velocity) {
    ForceLaw law(options, ModelScale{10});
    Contact contact = onPlane(below(0.25));
    contact.velocity = velocity;
    return law.update(contact, below(0.25), kTick_s);
  };
  // 2 N; a unit is ten millimetres.
  CHECK(felt_N({0, 0, 0}) == DVec3(0, 0, 2));
  CHECK(felt_N({0, 0, 20}) == DVec3(0, 0, 2));  // 0.4 W
  CHECK(felt_N({0, 0, 50}).z == near(1, 1e-6));
  CHECK(felt_N({0, 0, 500}).z == near(0.1, 1e-6));
  CHECK(felt_N({0, 0, -500}) == DVec3(0, 0, 2));  // it recedes: the hand does the work
  CHECK(felt_N({500, -500, 0}) == DVec3(0, 0, 2));
  options.maxSurfacePower_W = 0;
  CHECK(felt_N({0, 0, 1e-3}) == DVec3(0));
}

TEST_CASE("a given force is felt unchanged within the limits, pulls included") {
  ForceLaw law({.maxForce_N = 2, .maxRise_N_per_s = 500}, ModelScale{10});
  const auto felt_N = [&](const DVec3& given_N, const DVec3& velocity = DVec3(0)) {
    Contact contact = onPlane(below(1));
    contact.force_N = given_N;
    contact.velocity = velocity;
    return law.update(contact, below(1), kTick_s);
  };
  CHECK(felt_N({0, 0, -0.4}) == DVec3(0, 0, -0.4));  // the plane's own spring would push
  CHECK(felt_N({0, 0.03, -0.4}) == DVec3(0, 0.03, -0.4));
  CHECK(law.demand_N() == near(std::hypot(0.03, 0.4), 1e-6));
  const DVec3 before_N(0, 0.03, -0.4);
  CHECK(glm::distance(felt_N({5, 0.3, -0.4}), before_N) <= 0.05 + 1e-12);  // the hand rests: within a surface's limit
  DVec3 last(0);
  for (int i = 0; i < 50; ++i) last = felt_N({5, 0, 0});
  CHECK(glm::distance(last, DVec3(2, 0, 0)) < 1e-9);
  for (int i = 0; i < 40; ++i) last = felt_N({0.1, 0, 0});
  CHECK(glm::distance(last, DVec3(0.1, 0, 0)) < 1e-9);
  CHECK(felt_N({0.1, 0, 0}, {2000, 0, 0}).x == near(0.05, 1e-6));  // 1 W at 20 m/s
  CHECK(felt_N({kNaN, 0, 0}) == DVec3(0));
  CHECK(felt_N({0, kInfinity, 0}) == DVec3(0));
  CHECK(law.update({.proxy = {1, 2, 0}, .valid = true, .force_N = DVec3(1)}, below(1), kTick_s) == DVec3(0));
  CHECK(law.update({.touching = true, .force_N = DVec3(1)}, below(1), kTick_s) == DVec3(0));
}

TEST_CASE("a given torque scales with its force at a limit, and is zero without the force") {
  ForceLaw law({.maxForce_N = 2, .maxRise_N_per_s = 1e9}, ModelScale{10});
  Contact contact = onPlane(below(1));
  contact.force_N = DVec3(0, 1, 0);
  contact.torque_mNm = {3, 0, -6};
  law.update(contact, below(1), kTick_s);
  CHECK(law.torque_mNm() == DVec3(3, 0, -6));
  contact.force_N = DVec3(0, 4, 0);
  law.update(contact, below(1), kTick_s);
  CHECK(glm::distance(law.torque_mNm(), DVec3(1.5, 0, -3)) < 1e-12);
  contact.torque_mNm.x = kNaN;
  CHECK(law.update(contact, below(1), kTick_s) == DVec3(0));
  CHECK(law.torque_mNm() == DVec3(0));
  contact.torque_mNm.x = 3;
  law.update(contact, below(1), kTick_s);
  contact.force_N.reset();  // back to the plane's own spring
  law.update(contact, below(1), kTick_s);
  CHECK(law.torque_mNm() == DVec3(0));
}

TEST_CASE("a custom force law decides in contact, receives the default force, and stays within the limits") {
  struct Seen {
    DVec3 usual_N{0}, force_N{0.1, 0, -0.2};
    int calls = 0;
  } seen;
  ForceLaw law({.stiffness_N_per_mm = 0.5, .damping_N_s_per_mm = 0, .maxForce_N = 2, .maxRise_N_per_s = 500},
               ModelScale{10});
  law.setCustom({[](void* user, const Contact&, const Pose&, double, const DVec3& usual_N) noexcept {
                   auto& its = *static_cast<Seen*>(user);
                   its.usual_N = usual_N;
                   ++its.calls;
                   return its.force_N;
                 },
                 &seen});
  const auto felt_N = [&] { return law.update(onPlane(below(1)), below(1), kTick_s); };
  CHECK(felt_N() == DVec3(0.1, 0, -0.2));                      // pulls are allowed
  CHECK(glm::distance(seen.usual_N, DVec3(0, 0, 5)) < 1e-12);  // 10 mm at 0.5 N/mm
  seen.force_N = {0, 9, 0};
  CHECK(glm::distance(felt_N(), DVec3(0.1, 0, -0.2)) <= 0.05 + 1e-12);
  for (int i = 0; i < 50; ++i) felt_N();
  CHECK(glm::distance(felt_N(), DVec3(0, 2, 0)) < 1e-9);
  seen.force_N = {0, kNaN, 0};
  CHECK(felt_N() == DVec3(0));
  const int calls = seen.calls;
  CHECK(law.update({.proxy = {1, 2, 0}, .valid = true}, below(1), kTick_s) == DVec3(0));  // no contact
  CHECK(law.update({.touching = true}, below(1), kTick_s) == DVec3(0));                   // a fault
  CHECK(seen.calls == calls);
}

}  // namespace palpate::force_law_test
