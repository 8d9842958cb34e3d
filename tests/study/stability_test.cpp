#include "haptics/study/stability.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "engine/core/error.hpp"
#include "tests/near.hpp"

namespace palpate::stability_test {

TEST_CASE("a surface of 0.4 N/mm is held at rest without energy gain, plane or sphere, even with delay") {
  for (const StudySurface surface : {StudySurface::plane, StudySurface::sphere})
    for (const PassivityMode passivity : {PassivityMode::observe, PassivityMode::on})
      for (const double delay_ms : {0.0, 1.0, 3.0}) {
        CAPTURE(delay_ms);
        const StabilityResult result =
            measureStability({.passivity = passivity, .delay_ms = delay_ms, .surface = surface});
        CHECK_FALSE(result.limitCycle);
        CHECK(result.restMotion_mm < 0.055);
        CHECK(result.leastEnergy_mJ > -0.1);
        CHECK(result.peakForce_N > 0.3);
        CHECK(result.peakForce_N < 0.8);
      }
}

TEST_CASE("an excessive stiffness without the controller shakes the hand and adds energy; the controller calms it") {
  StabilityOptions options{.stiffness_N_per_mm = 20, .passivity = PassivityMode::observe};
  const StabilityResult shaken = measureStability(options);
  CHECK(shaken.limitCycle);
  CHECK(shaken.restMotion_mm > 1);
  CHECK(shaken.leastEnergy_mJ < -1);
  CHECK(shaken.peakForce_N == near(3.3, 1e-6));
  options.passivity = PassivityMode::on;
  CHECK(measureStability(options).restMotion_mm < shaken.restMotion_mm);
  options.passivity = PassivityMode::off;
  CHECK(measureStability(options).leastEnergy_mJ == 0);
}

TEST_CASE("every millisecond of delay lowers the largest stable stiffness") {
  StabilityOptions options{.passivity = PassivityMode::observe};
  double last_N_per_mm = std::numeric_limits<double>::infinity();
  for (const double delay_ms : {0.0, 1.0, 3.0}) {
    options.delay_ms = delay_ms;
    const double limit_N_per_mm = largestStableStiffness(options);
    CHECK(limit_N_per_mm < 0.8 * last_N_per_mm);
    last_N_per_mm = limit_N_per_mm;
  }
  CHECK(last_N_per_mm > 1);
}

// A late force does not change as the hand moves, so most of its change follows at the rate of the surface. That calms
// the hand as the controller does, and both together hold 4.2 N/mm at 3 ms: more than half of what they hold without.
TEST_CASE("delay lowers the largest stable stiffness with the passivity controller, too") {
  const auto limit = [](double delay_ms) { return largestStableStiffness({.delay_ms = delay_ms}); };
  const double none = limit(0), some = limit(3), much = limit(6);
  CHECK(some < 0.6 * none);
  CHECK(much < 0.7 * some);
  CHECK(much > 1.5);
}

TEST_CASE("the passivity controller raises the largest stable stiffness") {
  for (const double delay_ms : {0.0, 1.0, 3.0}) {
    StabilityOptions options{.passivity = PassivityMode::observe, .delay_ms = delay_ms};
    const double without = largestStableStiffness(options);
    options.passivity = PassivityMode::on;
    CHECK(largestStableStiffness(options) > 1.1 * without);
  }
}

TEST_CASE("damping raises the largest stable stiffness up to a point, and lowers it beyond") {
  const auto limit = [](double damping_N_s_per_mm) {
    return largestStableStiffness(
        {.damping_N_s_per_mm = damping_N_s_per_mm, .passivity = PassivityMode::observe, .delay_ms = 3});
  };
  const double none = limit(0), some = limit(0.008), much = limit(0.032);
  CHECK(some > 1.1 * none);
  CHECK(much < some);
}

TEST_CASE("without friction the limit is near that of the theory of sampled springs") {
  // K (T/2 + delay) < b + B for a massless hand (Colgate, Schenkel 1997); one tick of the device's own delay.
  StabilityOptions options{.passivity = PassivityMode::observe};
  options.touch.friction_N = 0;
  const double theory_N_per_mm = (0.0005 + 0.002 + 0.002) / 0.0015;
  const double limit_N_per_mm = largestStableStiffness(options);
  CHECK(limit_N_per_mm > 0.5 * theory_N_per_mm);
  CHECK(limit_N_per_mm < 2 * theory_N_per_mm);
}

TEST_CASE("a study out of range is refused, and a bracket without a limit gives its end") {
  CHECK_THROWS_AS(measureStability({.rate_Hz = 0}), UsageError);
  CHECK_THROWS_AS(measureStability({.delay_ms = -1}), UsageError);
  CHECK_THROWS_AS(measureStability({.delay_ms = std::numeric_limits<double>::quiet_NaN()}), UsageError);
  CHECK_THROWS_AS(measureStability({.depth_mm = 0}), UsageError);
  CHECK_THROWS_AS(measureStability({.radius_mm = 1}), UsageError);
  CHECK_THROWS_AS(largestStableStiffness({}, 1, 0.5), UsageError);
  CHECK(largestStableStiffness({}, 0.1, 0.4) == 0.4);
  CHECK(largestStableStiffness({}, 25, 30) == 25);
}

}  // namespace palpate::stability_test
