// Scale of a file's colours, determined by all of them, never by one row.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/cloud/scalar_type.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Files store colours from 0 to 1, to 255 or to 65535, and few declare which. Takes all numbers of a column, or of the
/// three of a colour, and then determines the value of full intensity.
class ColorScale {
 public:
  void take(double value) {
    if (!(value >= 0)) return;
    most_ = value > most_ ? value : most_;
    const auto whole = static_cast<std::uint64_t>(value < 1e9 ? value : 1e9);
    fractions_ = fractions_ || static_cast<double>(whole) != value;
    by256_ = by256_ && whole % 256 == 0;
  }
  /// `whole`: integer steps, as in integer types: 1 is then dark, not full intensity.
  double full(bool whole) const;
  /// The type whose usual full intensity is full().
  ScalarType storedAs(bool whole) const;

 private:
  double most_ = 0;
  bool fractions_ = false, by256_ = true;
};

/// Converts corner colours to bytes; corners without a colour become white. Returns their number.
std::size_t cornerColors(const std::vector<std::optional<DVec3>>& raw, bool whole,
                         std::vector<std::array<std::uint8_t, 4>>& bytes);

/// Share of `full` as a byte; 0 for NaN.
std::uint8_t colorByte(double value, double full);

/// Linear light, 0 to 1, as a byte of sRGB (IEC 61966-2-1), and back.
std::uint8_t srgbByte(double linear);
double linearOf(std::uint8_t srgb);

/// Scale of three colours from 0 to 1, to 255 or to 65535 for each of `count` rows, determined together.
template <class Rows>
ColorScale scaleOfColors(const Rows& rows) {
  ColorScale scale;
  for (const auto& row : rows)
    for (int k = 0; k < 3; ++k) scale.take(static_cast<double>(row[k]));
  return scale;
}

}  // namespace palpate
