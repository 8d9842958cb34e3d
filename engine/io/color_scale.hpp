// How large the numbers of a file's colours are: told by all of them, never by one row.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/cloud/scalar_type.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Files store the same colours from 0 to 1, to 255 or to 65535, and few say which. Takes every number of a column, or
/// of the three of a colour, and then says what full light is.
class ColorScale {
 public:
  void take(double value) {
    if (!(value >= 0)) return;
    most_ = value > most_ ? value : most_;
    const auto whole = static_cast<std::uint64_t>(value < 1e9 ? value : 1e9);
    fractions_ = fractions_ || static_cast<double>(whole) != value;
    by256_ = by256_ && whole % 256 == 0;
  }
  /// `whole`: numbers that count steps, as those of integer types do: 1 is dark then, and not full light.
  double full(bool whole) const;
  /// The type in which full() is the usual full light.
  ScalarType storedAs(bool whole) const;

 private:
  double most_ = 0;
  bool fractions_ = false, by256_ = true;
};

/// Colours of corners as bytes, of which some may have none: those are white. How many these are where others have one.
std::size_t cornerColors(const std::vector<std::optional<DVec3>>& raw, bool whole,
                         std::vector<std::array<std::uint8_t, 4>>& bytes);

/// Share of `full` as a byte; what is not a number is 0.
std::uint8_t colorByte(double value, double full);

/// Three colours from 0 to 1, to 255 or to 65535 for each of `count` rows, judged together.
template <class Rows>
ColorScale scaleOfColors(const Rows& rows) {
  ColorScale scale;
  for (const auto& row : rows)
    for (int k = 0; k < 3; ++k) scale.take(static_cast<double>(row[k]));
  return scale;
}

}  // namespace palpate
