// How long a motor may be driven beyond its continuous force.
#pragma once

namespace palpate {

/// The heat of the motors in a first-order model: copper loss grows with the square of the current and so of the force,
/// and heat dissipates with one time constant. Scaled so that the continuous force holds a heat of 1. A session starts
/// with cold motors.
class ThermalBudget {
 public:
  /// A peak or continuous force that is not above zero allows no force. Infinite forces are never limited.
  ThermalBudget(double peakForce_N, double continuousForce_N) noexcept;

  /// The maximum force that may be given now, N: the peak while there is room, reduced to the continuous force as the
  /// heat approaches 1, and restored as the motors cool.
  double allowed_N() const noexcept;

  /// A force of this size acted for `dt_s`.
  void spend(double force_N, double dt_s) noexcept;

  /// True while heat limits the force to less than the peak.
  bool isWarm() const noexcept { return allowed_N() < peak_N_; }
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    visit(heat_);
  }

 private:
  double peak_N_ = 0, continuous_N_ = 0;
  double heat_ = 0;  ///< 1: held by the continuous force
};

}  // namespace palpate
