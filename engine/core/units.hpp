// Units at the borders. Model coordinates are in the file's own unit; forces are N, lengths that a hand feels are mm.
#pragma once

namespace palpate {

/// Length of a model's longest side unless the user sets the size of a unit.
inline constexpr double kDefaultLongestSide_mm = 100.0;

/// Peak force of a Geomagic Touch, N. No force above the device's own peak ever leaves the servo loop.
inline constexpr double kTouchPeakForce_N = 3.3;

/// Millimetres per model unit, and conversions.
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
