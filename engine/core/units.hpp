// Units at the borders. Model coordinates are in the file's own unit; forces are N, lengths that a hand feels are mm.
#pragma once

namespace palpate {

/// The longest side of a model becomes this long unless the user says what one unit is.
inline constexpr double kDefaultLongestSide_mm = 100.0;

/// Peak force of a Geomagic Touch, N. No force above the device's own peak ever leaves the servo loop.
inline constexpr double kTouchPeakForce_N = 3.3;

/// How many millimetres one model unit is, and the way between the two.
struct ModelScale {
  double mm_per_unit = 1.0;

  double toMm(double units) const { return units * mm_per_unit; }
  double toUnits(double mm) const { return mm / mm_per_unit; }

  /// The scale that makes `longestSide_units` kDefaultLongestSide_mm long; 1 for a model without extent.
  static ModelScale fitting(double longestSide_units) {
    return {longestSide_units > 0 ? kDefaultLongestSide_mm / longestSide_units : 1.0};
  }
};

}  // namespace palpate
