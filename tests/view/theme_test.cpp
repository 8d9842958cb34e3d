// The colours of the panels can be read: contrast after WCAG 2.1, success criterion 1.4.3 (World Wide Web Consortium,
// 2018).
#include "apps/view/theme.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace palpate::theme_test {

namespace {

using Color = std::array<double, 3>;

Color channels(std::uint32_t color) {
  return {((color >> 16U) & 255U) / 255.0, ((color >> 8U) & 255U) / 255.0, (color & 255U) / 255.0};
}

double luminance(const Color& color) {
  const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
}

double contrast(const Color& a, const Color& b) {
  const double high = std::max(luminance(a), luminance(b)), low = std::min(luminance(a), luminance(b));
  return (high + 0.05) / (low + 0.05);
}

Color over(const Color& top, const Color& below, double opacity) {
  Color mixed;
  for (std::size_t c = 0; c < 3; ++c) mixed[c] = opacity * top[c] + (1 - opacity) * below[c];
  return mixed;
}

}  // namespace

TEST_CASE("each text of the panels has a contrast of at least 4.5 in both themes, also where it cannot be used now") {
  CHECK(contrast({0, 0, 0}, {1, 1, 1}) > 20.99);
  for (const bool isDark : {true, false}) {
    CAPTURE(isDark);
    const auto of = [isDark](Tone tone) { return channels(colorOf(tone, isDark)); };
    for (const auto& pair : kTextOn) {
      CAPTURE(static_cast<int>(pair.first));
      CAPTURE(static_cast<int>(pair.second));
      CHECK(contrast(of(pair.first), of(pair.second)) >= 4.5);
    }
    for (const Tone background : {Tone::panel, Tone::field, Tone::button}) {
      const Color below = over(of(background), of(Tone::panel), double{kDisabledOpacity});
      CHECK(contrast(over(of(Tone::text), below, double{kDisabledOpacity}), below) >= 4.5);
    }
  }
}

TEST_CASE("the table of colours is in the order of its tones, and names each text with its background once") {
  for (std::size_t k = 0; k < kThemeColors.size(); ++k) CHECK(static_cast<std::size_t>(kThemeColors[k].tone) == k);
  CHECK(std::set(kTextOn.begin(), kTextOn.end()).size() == kTextOn.size());
  CHECK(inkOf(Tone::error, true) == 0xff909affU);  // red lowest
}

}  // namespace palpate::theme_test
