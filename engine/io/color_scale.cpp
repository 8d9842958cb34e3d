#include "engine/io/color_scale.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

double ColorScale::full(bool whole) const {
  constexpr double kByte = 255, kUpperByte = 65280, kTwoBytes = 65535;
  constexpr double kOverlit = 4;  // relative intensities may slightly exceed 1
  if (!whole && (most_ <= 1 || (fractions_ && most_ <= kOverlit))) return 1;
  if (most_ <= kByte) return kByte;
  return by256_ ? kUpperByte : kTwoBytes;
}

ScalarType ColorScale::storedAs(bool whole) const {
  const double most = full(whole);
  return most <= 1 ? ScalarType::f32 : most <= 255 ? ScalarType::u8 : ScalarType::u16;
}

std::size_t cornerColors(const std::vector<std::optional<DVec3>>& raw, bool whole,
                         std::vector<std::array<std::uint8_t, 4>>& bytes) {
  ColorScale scale;
  std::size_t missing = 0;
  for (const auto& color : raw)
    for (int k = 0; color && k < 3; ++k) scale.take((*color)[k]);
  const double full = scale.full(whole);
  for (const auto& color : raw) {
    const DVec3 shown = color.value_or(DVec3(full));
    bytes.push_back({colorByte(shown.x, full), colorByte(shown.y, full), colorByte(shown.z, full), 255});
    missing += !color;
  }
  return missing;
}

std::uint8_t colorByte(double value, double full) {
  const double share = value / full;
  return static_cast<std::uint8_t>(share > 0 ? std::lround(255 * std::min(share, 1.0)) : 0);
}

std::uint8_t srgbByte(double linear) {
  return colorByte(linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055, 1);
}

double linearOf(std::uint8_t srgb) {
  const double value = srgb / 255.0;
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

}  // namespace palpate
