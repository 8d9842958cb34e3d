// Which stiffness a hand can hold: the servo loop with the simulated Touch and an analytic surface.
#pragma once

#include "haptics/devices/simulated_touch.hpp"
#include "haptics/passivity.hpp"

namespace palpate {

enum class StudySurface { plane, sphere };

struct StabilityOptions {
  double stiffness_N_per_mm = 0.4;
  double damping_N_s_per_mm = 0.002;
  PassivityMode passivity = PassivityMode::on;
  double rate_Hz = 1000;
  /// Age of each answer, rounded to whole ticks: the force is that of the hand's pose at that time. This is the worst
  /// case of a late answer; a back end that extrapolates its last answer to the present pose does better.
  double delay_ms = 0;
  StudySurface surface = StudySurface::plane;
  double radius_mm = 20;  ///< of the sphere
  /// Below the surface, where the hand intends to rest. Its stiffness times this is best kept below the device's
  /// continuous force: hot motors yield, and the study would count that as motion.
  double depth_mm = 2;
  double approach_mm_per_s = 100;  ///< speed of the approach: a brisk tap, since a gentle one excites less
  SimulatedTouchOptions touch;     ///< its lead_s is not used
};

struct StabilityResult {
  bool limitCycle = false;    ///< at rest the stylus still moves by more than one encoder step
  double restMotion_mm = 0;   ///< longest side of the box in which the stylus moves over the last half second
  double leastEnergy_mJ = 0;  ///< minimum energy of the surface; see Passivity. 0 with the observer off
  double peakForce_N = 0;
};

/// The hand waits until forces are fully on, presses onto the surface and rests there for two seconds of virtual time.
/// Takes some milliseconds; the same options give the same result. Throws UsageError for options out of range.
StabilityResult measureStability(const StabilityOptions& options);

/// The maximum stiffness, N/mm, without a limit cycle, by bisection between `low` and `high` to one percent: `low` if
/// that already has one, `high` if even that has none. The other options as given.
double largestStableStiffness(const StabilityOptions& options, double low_N_per_mm = 0.01, double high_N_per_mm = 30);

}  // namespace palpate
