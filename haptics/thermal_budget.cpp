#include "haptics/thermal_budget.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// The windings of motors of this size warm and cool with a time constant of ten to thirty seconds. A larger value
/// trusts the motors for longer: at 20 s a Touch gives its peak of 3.3 N for a second before it is reduced.
constexpr double kCooling_s = 20;

/// Share of the allowed heat over which the force is reduced from peak to continuous. A smaller value keeps the peak
/// for longer and then drops it so fast that the hand feels the step.
constexpr double kEasing = 0.3;

}  // namespace

ThermalBudget::ThermalBudget(double peakForce_N, double continuousForce_N) noexcept {
  if (!(peakForce_N > 0 && continuousForce_N > 0)) return;
  peak_N_ = peakForce_N;
  continuous_N_ = std::min(continuousForce_N, peakForce_N);
}

double ThermalBudget::allowed_N() const noexcept {
  if (continuous_N_ == peak_N_) return peak_N_;
  const double room = std::clamp((1 - heat_) / kEasing, 0.0, 1.0);
  // Linear in the square of the force, so that a steady demand settles at the continuous force without overshoot.
  return std::sqrt(continuous_N_ * continuous_N_ + room * (peak_N_ * peak_N_ - continuous_N_ * continuous_N_));
}

void ThermalBudget::spend(double force_N, double dt_s) noexcept {
  if (continuous_N_ == peak_N_ || !(dt_s > 0)) return;
  const double load = force_N / continuous_N_;
  heat_ += (load * load - heat_) * -std::expm1(-dt_s / kCooling_s);  // exact for a constant force
}

}  // namespace palpate
