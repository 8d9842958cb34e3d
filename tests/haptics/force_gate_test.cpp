#include "haptics/force_gate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/near.hpp"

namespace palpate::force_gate_test {

namespace {

constexpr double kTick_s = 0.001;
const DVec3 kPush(0, 0, 0.8);

/// Ticks of a gate with a desired force of 0.8 N.
struct Gate {
  ForceGate gate{DeviceLimits{}, kTick_s};

  double tick(TickSigns signs = {}, const DVec3& wanted_N = kPush) {
    signs.demand_N = std::isfinite(wanted_N.z) ? glm::length(wanted_N) : 0;
    return glm::length(gate.pass(wanted_N, signs, kTick_s));
  }
  /// The force after `time_s`.
  double after(double time_s, TickSigns signs = {}, const DVec3& wanted_N = kPush) {
    double last = 0;
    for (int i = 0; i < std::lround(time_s / kTick_s); ++i) last = tick(signs, wanted_N);
    return last;
  }
  double free(double time_s) { return after(time_s, {}, DVec3(0)); }
};

Gate engaged() {
  Gate gate;
  gate.free(0.6);
  REQUIRE(gate.tick() == near(0.8, 1e-6));
  return gate;
}

constexpr double kPeak_N = 3.3, kContinuous_N = 0.88;

/// Gives the maximum allowed force for `time_s`; returns the final one.
double drive(ThermalBudget& motors, double demand_N, double time_s) {
  double given_N = 0;
  for (int i = 0; i < std::lround(time_s / kTick_s); ++i) {
    given_N = std::min(demand_N, motors.allowed_N());
    motors.spend(given_N, kTick_s);
  }
  return given_N;
}

}  // namespace

TEST_CASE("forces ramp up over half a second after they are enabled, and not at each contact") {
  Gate gate;
  gate.free(kTick_s);
  double last = gate.tick();
  CHECK(last < 0.004);
  for (int i = 2; i < 499; ++i) {
    const double now = gate.tick();
    CHECK(now > last);
    CHECK(now - last < 0.8 * kTick_s / 0.5 + 1e-12);
    last = now;
  }
  CHECK(gate.tick() == near(0.8, 1e-6));
  CHECK(gate.free(0.1) == 0);
  CHECK(gate.tick() == near(0.8, 1e-6));
}

TEST_CASE("a session that starts inside gives no force until the hand has been outside once") {
  Gate gate;
  CHECK(gate.after(2) == 0);
  CHECK(gate.after(kTick_s, {}, DVec3(0, 0, 0.05)) > 0);  // a demand below 0.1 N counts as outside
  CHECK(gate.tick() < 0.01);
  CHECK(gate.after(0.6) == near(0.8, 1e-6));
}

TEST_CASE("an old answer does not show that the hand is outside") {
  Gate gate;
  gate.after(0.1, {.fresh = false}, DVec3(0));
  CHECK(gate.after(1) == 0);
}

TEST_CASE("after a short error the force ramps up from zero; after a long one it also waits for a small demand") {
  Gate gate = engaged();
  TickSigns error;
  DVec3 wanted = kPush;
  SUBCASE("no valid answer") { error.answered = false; }
  SUBCASE("a force that is not a number") { wanted.z = std::numeric_limits<double>::quiet_NaN(); }
  SUBCASE("an infinite force") { wanted.z = std::numeric_limits<double>::infinity(); }
  CHECK(gate.after(0.05, error, wanted) == 0);
  CHECK(gate.tick() < 0.01);
  CHECK(gate.after(0.25) == near(0.4, 0.01));
  CHECK(gate.after(0.3) == near(0.8, 1e-6));
  CHECK(gate.after(0.2, error, wanted) == 0);
  CHECK(gate.after(1) == 0);
  CHECK(gate.free(0.6) == 0);
  CHECK(gate.tick() == near(0.8, 1e-6));
  CHECK(gate.gate.counts().errors == 2);
}

TEST_CASE("after a jump of the device the hand must be outside before it feels a force") {
  Gate gate = engaged();
  CHECK(gate.tick({.jumped = true}) == 0);
  CHECK(gate.after(1) == 0);
  gate.free(kTick_s);
  CHECK(gate.tick() < 0.01);
}

TEST_CASE("a pause between ticks counts as an error") {
  Gate gate = engaged();
  CHECK(glm::length(gate.gate.pass(kPush, {.demand_N = 0.8}, 0.02)) == near(0.8, 1e-6));
  CHECK(glm::length(gate.gate.pass(kPush, {.demand_N = 0.8}, 0.08)) == 0);
  CHECK(gate.tick() < 0.01);
  gate = engaged();
  CHECK(glm::length(gate.gate.pass(kPush, {.demand_N = 0.8}, -1)) == 0);
  CHECK(glm::length(gate.gate.pass(kPush, {.demand_N = 0.8}, std::numeric_limits<double>::quiet_NaN())) == 0);
}

TEST_CASE("a slow tick rate does not count as a pause") {
  ForceGate gate(DeviceLimits{}, 0.2);
  gate.pass(DVec3(0), {}, 0.2);
  for (int i = 0; i < 3; ++i) gate.pass(kPush, {.demand_N = 0.8}, 0.2);
  CHECK(glm::length(gate.pass(kPush, {.demand_N = 0.8}, 0.2)) == near(0.8, 1e-6));
}

TEST_CASE("stale data keep their force for 20 ms and lose it over 50 ms; fresh data bring it back with the ramp") {
  Gate gate = engaged();
  CHECK(gate.after(0.019, {.fresh = false}) == near(0.8, 1e-6));
  double last = gate.tick({.fresh = false});
  for (int i = 0; i < 49; ++i) {
    const double now = gate.tick({.fresh = false});
    CHECK(now < last);
    CHECK(last - now < 0.017);
    last = now;
  }
  CHECK(gate.after(1, {.fresh = false}) == within(0, 1e-6));
  CHECK(gate.gate.counts().stale > 1000);
  CHECK(gate.tick() < 0.01);
  CHECK(gate.after(0.5) == near(0.8, 1e-6));
}

TEST_CASE("answers that report their age keep their force while it is small, and lose it when it grows") {
  Gate gate = engaged();
  CHECK(gate.after(1, {.fresh = false, .age_s = 0.0004}) == near(0.8, 1e-6));
  CHECK(gate.gate.counts().stale == 0);
  CHECK(gate.after(0.05, {.fresh = false, .age_s = 0.5}) < 0.5);  // the age grows at most as fast as time
  CHECK(gate.after(0.1, {.fresh = false, .age_s = 0.5}) == within(0, 1e-6));
}

TEST_CASE("forces switched off are zero at once and return only after a small demand and with the ramp") {
  Gate gate = engaged();
  CHECK(gate.tick({.on = false}) == 0);
  CHECK(gate.after(0.3, {.on = false}, DVec3(0)) == 0);
  CHECK(gate.after(1) == 0);  // switched on during contact
  gate.free(kTick_s);
  CHECK(gate.after(0.25) == near(0.4, 0.01));
}

TEST_CASE(
    "a force fades with the known share of the surface, rises with the ramp, and once zero waits for a small demand") {
  Gate gate = engaged();
  // Even if the knowledge ends at once, the force fades.
  double last = 0.8;
  for (int i = 0; i < 50; ++i) {
    const double now = gate.tick({.known = 0});
    CHECK(last - now < 0.8 * kTick_s / 0.05 + 1e-9);
    last = now;
  }
  CHECK(last == within(0, 1e-6));
  CHECK(gate.gate.counts().aged == 50);
  gate.tick({.known = 0});
  CHECK(gate.after(1) == 0);  // known again, and the hand is still inside
  gate.free(kTick_s);
  CHECK(gate.after(0.25) == near(0.4, 0.01));
  // A share of 0.5 of the points known halves the force, which returns through the ramp without a wait.
  Gate other = engaged();
  CHECK(other.after(0.2, {.known = 0.5}) == near(0.4, 1e-6));
  CHECK(other.after(0.1) == near(0.56, 0.01));
  CHECK(other.after(0.2) == near(0.8, 1e-6));
  // While nothing is known a small demand does not end the wait.
  Gate blind = engaged();
  blind.after(0.2, {.known = 0});
  blind.after(0.2, {.known = 0}, DVec3(0));
  CHECK(blind.after(0.2) == 0);
  Gate broken = engaged();
  CHECK(broken.after(0.1, {.known = std::numeric_limits<double>::quiet_NaN()}) == 0);
}

TEST_CASE("the peak force is never exceeded, and hot motors get the continuous force") {
  Gate gate = engaged();
  const DVec3 hard(0, 30, 40);
  CHECK(gate.tick({}, hard) == near(3.3, 1e-6));
  CHECK(gate.after(30, {}, hard) == near(0.88, 0.01));
  CHECK(gate.gate.counts().hot > 20'000);
  CHECK(gate.gate.isHot());
  gate.free(30);
  CHECK(gate.tick({}, hard) == near(3.3, 1e-6));
}

TEST_CASE("a script without a hand starts with full force, and ramps up after its errors") {
  ForceGate gate({.handHeld = false}, kTick_s);
  CHECK(gate.pass(kPush, {.demand_N = 0.8}, kTick_s) == kPush);
  CHECK(gate.pass(kPush, {.answered = false, .demand_N = 0.8}, kTick_s) == DVec3(0));
  CHECK(glm::length(gate.pass(kPush, {.demand_N = 0.8}, kTick_s)) < 0.01);
}

TEST_CASE("the peak force is allowed for a second, then eases to the continuous force without a step") {
  ThermalBudget motors(kPeak_N, kContinuous_N);
  CHECK(drive(motors, 10, 1) == kPeak_N);
  double last_N = kPeak_N, largestStep_N = 0;
  for (int i = 0; i < 10'000; ++i) {
    const double now_N = drive(motors, 10, kTick_s);
    CHECK(now_N <= last_N);
    largestStep_N = std::max(largestStep_N, last_N - now_N);
    last_N = now_N;
  }
  CHECK(largestStep_N < 0.02);
  CHECK(last_N == near(kContinuous_N, 0.01));
  CHECK(motors.isWarm());
}

TEST_CASE("the continuous force is allowed forever, and a lower one leaves room for a peak") {
  ThermalBudget motors(kPeak_N, kContinuous_N);
  CHECK(drive(motors, kContinuous_N, 600) == kContinuous_N);
  ThermalBudget rested(kPeak_N, kContinuous_N);
  drive(rested, 0.5, 600);
  CHECK(drive(rested, 10, 0.3) == kPeak_N);
}

TEST_CASE("motors recover at rest") {
  ThermalBudget motors(kPeak_N, kContinuous_N);
  drive(motors, 10, 20);
  CHECK(motors.allowed_N() < 1);
  drive(motors, 0, 30);
  CHECK(motors.allowed_N() == kPeak_N);
  CHECK_FALSE(motors.isWarm());
}

TEST_CASE("the heat does not depend on how time is divided into ticks") {
  ThermalBudget coarse(kPeak_N, kContinuous_N), fine(kPeak_N, kContinuous_N);
  for (int i = 0; i < 10; ++i) coarse.spend(2, 0.5);
  for (int i = 0; i < 50'000; ++i) fine.spend(2, 0.0001);
  CHECK(coarse.allowed_N() == near(fine.allowed_N(), 1e-6));
}

TEST_CASE("a device without motors is never limited, and limits that are not numbers allow nothing") {
  constexpr double kNone = std::numeric_limits<double>::infinity(), kNaN = std::numeric_limits<double>::quiet_NaN();
  ThermalBudget script(kNone, kNone);
  CHECK(drive(script, 1e6, 10) == 1e6);
  CHECK(ThermalBudget(kNaN, 1).allowed_N() == 0);
  CHECK(ThermalBudget(-1, 1).allowed_N() == 0);
  CHECK(ThermalBudget(2, 5).allowed_N() == 2);
  ThermalBudget weak(2, kNaN);
  CHECK(drive(weak, 1, 1) < 0.01);
}

}  // namespace palpate::force_gate_test
