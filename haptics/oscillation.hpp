#pragma once

namespace palpate {

/// Detects the hum of an unstable contact: a motion above 20 Hz, faster than any tremor of a hand, whose force is a
/// share of the contact's mean force, and which lasts without decaying. The ringing after an impact decays.
class Oscillation {
 public:
  static constexpr double kCorner_Hz = 20;
  /// Begins above the first share of the mean force and ends below the second one; below kSmallest_N nothing is felt.
  static constexpr double kBegins = 0.15, kEnds = 0.08, kSmallest_N = 0.05;
  /// Until it is believed, if its power meanwhile stays above this share of its maximum.
  static constexpr double kLasts_s = 0.05, kSustained = 0.6;

  /// `depth_mm`: below the wall, negative outside. True once the oscillation has lasted.
  bool update(double depth_mm, double stiffness_N_per_mm, double dt_s) noexcept;
  void reset() noexcept { *this = {}; }
  /// Since it began or last decayed; 0 if there is none.
  double duration_s() const noexcept { return sustained_s_; }

 private:
  bool known_ = false;
  double position_mm_ = 0, once_mm_ = 0, fast_mm_ = 0;  ///< high-passed once and twice
  double power_mm2_ = 0, mean_N_ = 0;
  bool isOn_ = false;
  double maxPower_mm2_ = 0, sustained_s_ = 0;  ///< since it began or last decayed
};

}  // namespace palpate
