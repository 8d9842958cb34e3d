#include "haptics/passivity.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "tests/near.hpp"

namespace palpate::passivity_test {
namespace {

constexpr double kTick_s = 0.001;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A spring of 1 N/mm above z = 0, pressed from above; its force is `lateTicks` ticks old.
class Spring {
 public:
  explicit Spring(PassivityMode mode, std::size_t lateTicks = 0)
      : passivity(mode, DeviceLimits{}, 1), depths_mm_(lateTicks, 0.0) {}

  double wanted_N() const { return std::max(0.0, late_mm_); }

  double tick(double depth_mm) {
    depths_mm_.push_back(depth_mm);
    late_mm_ = depths_mm_.front();
    depths_mm_.pop_front();
    const DVec3 force_N = passivity.damped({0, 0, wanted_N()}, {0, 0, -depth_mm}, kTick_s);
    passivity.acted(force_N);
    return force_N.z;
  }

  Passivity passivity;

 private:
  std::deque<double> depths_mm_;
  double late_mm_ = 0;
};

}  // namespace

TEST_CASE("pressing a spring adds its energy, and being pushed out removes it") {
  Spring spring(PassivityMode::observe);
  for (int i = 0; i <= 1000; ++i) spring.tick(2e-3 * i);
  CHECK(spring.passivity.energy_mJ() == near(0.5 * 2 * 2, 0.002));
  for (int i = 1000; i >= 1; --i) spring.tick(2e-3 * i);
  // The held force of a sampled spring returns slightly more than it took: stiffness times step times depth.
  CHECK(spring.passivity.energy_mJ() == near(-2e-3 * 2, 0.01));
  CHECK(spring.passivity.leastEnergy_mJ() == spring.passivity.energy_mJ());
}

TEST_CASE("a hand that withdraws fast gets no more energy than is left") {
  for (const double way_mm : {1.0, 0.5, 0.25}) {
    CAPTURE(way_mm);
    Spring spring(PassivityMode::on);
    const int ticks = static_cast<int>(std::lround(5 / way_mm));
    for (int i = 0; i <= ticks; ++i) spring.tick(way_mm * i);
    // Halfway out it still has the spring's full force, except after a reversal faster than any hand's.
    for (int i = ticks - 1; i >= 0; --i) {
      const double force_N = spring.tick(way_mm * i);
      if (2 * i > ticks && way_mm < 0.5) CHECK(force_N == spring.wanted_N());
    }
    spring.tick(-way_mm);
    CHECK(spring.passivity.leastEnergy_mJ() > -0.01);
  }
}

TEST_CASE("an ended contact leaves neither credit nor debt for the next") {
  Spring spring(PassivityMode::observe);
  for (int i = 0; i <= 100; ++i) spring.tick(0.02 * i);
  spring.tick(-1);
  CHECK(spring.passivity.energy_mJ() == 0);
  spring.tick(-2);
  spring.tick(-3);
  CHECK(spring.passivity.energy_mJ() == 0);
}

TEST_CASE("a passivity observer changes no force") {
  Spring spring(PassivityMode::observe, 5);
  for (int i = 0; i < 2000; ++i) {
    const double force_N = spring.tick(1 + std::sin(0.05 * i));
    CHECK(force_N == spring.wanted_N());
  }
  CHECK(spring.passivity.leastEnergy_mJ() < -0.5);
}

TEST_CASE("the passivity controller removes the energy of a delay, and never turns a push into a pull") {
  Spring observed(PassivityMode::observe, 5), braked(PassivityMode::on, 5);
  for (int i = 0; i < 2000; ++i) {
    const double depth_mm = 2 + std::sin(0.05 * i);
    observed.tick(depth_mm);
    CHECK(braked.tick(depth_mm) >= 0);
  }
  CHECK(observed.passivity.leastEnergy_mJ() < -10);
  CHECK(braked.passivity.leastEnergy_mJ() > 0.4 * observed.passivity.leastEnergy_mJ());
}

TEST_CASE("free space has no force, even on the tick after a contact that owes energy") {
  Passivity passivity(PassivityMode::on, {.forceDelay_ticks = 1}, 1);
  DVec3 position(0);
  for (int i = 0; i < 10; ++i) {
    passivity.acted(passivity.damped({0, 0, 1}, position, kTick_s));
    position.z += 0.1;  // pushed out
  }
  REQUIRE(passivity.energy_mJ() < 0);
  for (int i = 0; i < 3; ++i) {
    CHECK(passivity.damped(DVec3(0), position, kTick_s) == DVec3(0));
    passivity.acted(DVec3(0));
    position.z += 0.1;
  }
  CHECK(passivity.energy_mJ() == 0);
}

TEST_CASE("a contact's debt from before others change the surface is not charged to the hand") {
  Passivity passivity(PassivityMode::on, {.mostDamping_N_s_per_mm = 0.0001}, 1);
  DVec3 position(0);
  for (int i = 0; i < 30; ++i) {
    passivity.acted(passivity.damped({0, 0, 1}, position, kTick_s));
    position.z += 0.15;  // pushed out by the surface that the hand's own brush raised
  }
  const double owed_mJ = passivity.energy_mJ();
  REQUIRE(owed_mJ < -2);
  passivity.changed();
  // A spring of 1 N/mm that stores half a millijoule.
  const DVec3 force = passivity.damped({0, 0, 1}, position - DVec3(0, 0, 0.15), kTick_s);
  CHECK(force.z == near(1, 1e-6));
  passivity.acted(force);
  CHECK(passivity.leastEnergy_mJ() == owed_mJ);
  // The change excuses the energy before it only: energy that the surface returns from then on counts.
  for (int i = 0; i < 100; ++i) {
    passivity.changed();
    position.z += 0.1;
    passivity.acted(passivity.damped({0, 0, 1}, position, kTick_s));
  }
  CHECK(passivity.energy_mJ() > -1.2 * Passivity::kLent_mJ);
}

TEST_CASE("the passivity damping stays within the device's limit") {
  Passivity passivity(PassivityMode::on, {.mostDamping_N_s_per_mm = 0.003}, 1);
  DVec3 position(0);
  double strongest_N_s_per_mm = 0;
  for (int i = 0; i < 100; ++i) {
    const double step_mm = i % 2 ? 0.02 : 0.03;
    position.z += step_mm;  // pushed out endlessly
    const DVec3 wanted(0, 0, 3);
    const DVec3 force = passivity.damped(wanted, position, kTick_s);
    strongest_N_s_per_mm = std::max(strongest_N_s_per_mm, (wanted.z - force.z) / (step_mm / kTick_s));
    passivity.acted(force);
  }
  CHECK(strongest_N_s_per_mm == near(0.003, 1e-6));
}

TEST_CASE("a force that acts a tick late is counted when it acts") {
  Passivity late(PassivityMode::observe, {.forceDelay_ticks = 1}, 1);
  late.damped(DVec3(0), DVec3(0), kTick_s);
  late.acted({1, 0, 0});
  late.damped({1, 0, 0}, {1, 0, 0}, kTick_s);  // not received yet
  late.acted({1, 0, 0});
  CHECK(late.energy_mJ() == 0);
  late.damped({1, 0, 0}, {3, 0, 0}, kTick_s);
  CHECK(late.energy_mJ() == -2);
}

TEST_CASE("jumps, invalid numbers and the mode off count no energy") {
  Passivity passivity(PassivityMode::on, {}, 1);
  const DVec3 force(0, 0, 1);
  passivity.damped(force, {0, 0, 0}, kTick_s);
  passivity.acted(force);
  passivity.lift();
  CHECK(passivity.damped(force, {0, 0, 100}, kTick_s) == force);
  CHECK(passivity.damped(force, {0, kNaN, 0}, kTick_s) == force);
  CHECK(passivity.damped(force, {0, 0, 100}, 0) == force);
  CHECK(passivity.leastEnergy_mJ() == 0);

  Passivity off(PassivityMode::off, {}, 1);
  for (int i = 0; i < 10; ++i) {
    CHECK(off.damped(force, {0, 0, 1.0 * i}, kTick_s) == force);
    off.acted(force);
  }
  CHECK(off.leastEnergy_mJ() == 0);
}

TEST_CASE(
    "while others change the surface, the energy a contact gives beyond what it took is bounded for any duration") {
  for (const int delay : {0, 1, 3})
    for (const double step_mm : {0.002, 0.055})
      for (const bool flickers : {false, true}) {
        CAPTURE(delay);
        CAPTURE(step_mm);
        CAPTURE(flickers);
        Passivity passivity(PassivityMode::on, {.forceDelay_ticks = delay}, 0.8);
        DVec3 position(0);
        double last_N = 0, steepest_N = 0, least_N = 0;
        for (int i = 0; i < 20'000; ++i) {
          if (i > 100) passivity.changed();
          const double want_N = std::min(3.0, 0.06 * i);
          const DVec3 force_N = passivity.damped({0, 0, want_N}, position, kTick_s);
          least_N = std::min(least_N, force_N.z);
          steepest_N = std::max(steepest_N, force_N.z - last_N);
          last_N = force_N.z;
          passivity.acted(force_N);
          // In at first, then out endlessly, or between two encoder steps.
          const double way_mm = i < 100 ? -0.01 : flickers ? (i % 2 ? step_mm : -step_mm) : i % 7 ? 0 : step_mm;
          position.z += way_mm;
        }
        CHECK(least_N == 0);
        CHECK(steepest_N < 0.0601);
        CHECK(passivity.leastEnergy_mJ() > -1.2 * Passivity::kLent_mJ);
        if (!flickers) CHECK(last_N == 0);
        // In free space the energy is reset, and the next contact has its full force.
        for (int i = 0; i <= delay; ++i) passivity.acted(passivity.damped(DVec3(0), position, kTick_s));
        CHECK(passivity.energy_mJ() == 0);
        CHECK(passivity.damped({0, 0, 3}, position, kTick_s).z == 3);
      }
}

TEST_CASE("a force that the energy no longer allows falls by 60 N/s where the hand rests, and is cut where it costs") {
  // Pushed in by half a millimetre, with a force that the surface alone has raised to 3 N.
  const auto pressed = [](double way_mm, double& least_mJ) {
    Passivity passivity(PassivityMode::on, {}, 0.8);
    DVec3 position(0);
    double last_N = 3, steepest_N = 0;
    for (int i = 0; i < 160; ++i) {
      const bool isChanging = i >= 50;
      if (isChanging) passivity.changed();
      position.z += isChanging ? way_mm : -0.01;
      const DVec3 force_N = passivity.damped({0, 0, 3}, position, kTick_s);
      passivity.acted(force_N);
      if (isChanging) steepest_N = std::max(steepest_N, last_N - force_N.z - 0.8 * way_mm);
      last_N = force_N.z;
    }
    CHECK(last_N < 2.2);
    least_mJ = passivity.leastEnergy_mJ();
    return steepest_N;
  };
  double least_mJ = 0;
  CHECK(pressed(0, least_mJ) < 0.0601);
  CHECK(least_mJ == 0);
  for (const double way_mm : {0.005, 0.02, 0.1, 0.3}) {
    CAPTURE(way_mm);
    pressed(way_mm, least_mJ);
    CHECK(least_mJ > -1.2 * Passivity::kLent_mJ - Passivity::kFall_mJ);
  }
}

TEST_CASE("a hand that sinks in after all energy is spent meets a force again") {
  Passivity passivity(PassivityMode::on, {}, 0.8);
  DVec3 position(0);
  const auto tick = [&](double way_mm) {
    position.z += way_mm;
    const DVec3 force_N = passivity.damped({0, 0, 3}, position, kTick_s);
    passivity.acted(force_N);
    return force_N.z;
  };
  passivity.changed();
  for (int i = 0; i < 200; ++i) tick(0.02);
  CHECK(tick(0.02) == 0);
  double force_N = 0;
  for (int i = 0; i < 200; ++i) force_N = tick(-0.02);
  CHECK(force_N == 3);  // after 4 mm of 0.8 N/mm
}

TEST_CASE("on a moving surface the energy counts the hand's displacement relative to it") {
  Passivity carried(PassivityMode::observe, DeviceLimits{}, 1), pressed(PassivityMode::observe, DeviceLimits{}, 1);
  const DVec3 velocity_mm_per_s(30, 0, 200);
  for (int i = 0; i <= 500; ++i) {
    // One hand presses 2 mm into a surface at rest, the other into one that carries it along.
    const double depth_mm = 2 * std::sin(0.01 * i);
    const DVec3 force_N(0, 0, std::max(0.0, depth_mm));
    for (const bool moves : {false, true}) {
      Passivity& passivity = moves ? carried : pressed;
      const DVec3 surface_mm_per_s = moves ? velocity_mm_per_s : DVec3(0);
      const DVec3 place_mm = DVec3(0, 0, -depth_mm) + kTick_s * i * surface_mm_per_s;
      CHECK(passivity.damped(force_N, place_mm, kTick_s, surface_mm_per_s) == force_N);
      passivity.acted(force_N);
    }
    CHECK(std::abs(carried.energy_mJ() - pressed.energy_mJ()) < 1e-9);
  }
  CHECK(carried.leastEnergy_mJ() > -0.05);
  CHECK(pressed.leastEnergy_mJ() > -0.05);
}

}  // namespace palpate::passivity_test
