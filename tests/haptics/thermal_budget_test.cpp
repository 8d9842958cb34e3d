#include "haptics/thermal_budget.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/near.hpp"

namespace palpate::thermal_budget_test {
namespace {

constexpr double kTick_s = 0.001;
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

}  // namespace palpate::thermal_budget_test
