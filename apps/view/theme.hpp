// The colours of the window's panels in its two themes, and which text is shown on which background.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace palpate {

/// `faint`: text of less importance; `mark`: keys and what is being drawn; `chosen`: a button that is on; `alarm`: the
/// background of errors.
enum class Tone : std::uint8_t {
  text,
  faint,
  mark,
  error,
  panel,
  field,
  fieldHovered,
  button,
  buttonHovered,
  chosen,
  header,
  headerHovered,
  alarm,
  alarmText,
  alarmButton,
  accent
};

struct ThemeColor {
  Tone tone;
  std::uint32_t dark, light;  ///< 0xRRGGBB
};
inline constexpr std::array<ThemeColor, 16> kThemeColors{{{Tone::text, 0xf1f1ef, 0x17191b},
                                                          {Tone::faint, 0xb4b9bf, 0x4a4f55},
                                                          {Tone::mark, 0xffc464, 0x7a4300},
                                                          {Tone::error, 0xff9a90, 0xa3001c},
                                                          {Tone::panel, 0x1e2023, 0xf5f4f1},
                                                          {Tone::field, 0x32363c, 0xffffff},
                                                          {Tone::fieldHovered, 0x3d434b, 0xe9eef5},
                                                          {Tone::button, 0x383e46, 0xdee2e7},
                                                          {Tone::buttonHovered, 0x464e59, 0xcbd4de},
                                                          {Tone::chosen, 0x1c5186, 0xa5cbf2},
                                                          {Tone::header, 0x2c3137, 0xe3e6ea},
                                                          {Tone::headerHovered, 0x3a424c, 0xd3dae2},
                                                          {Tone::alarm, 0x9a1717, 0x9a1717},
                                                          {Tone::alarmText, 0xffffff, 0xffffff},
                                                          {Tone::alarmButton, 0xb53535, 0xb53535},
                                                          {Tone::accent, 0x5aa9f5, 0x1f6fbf}}};
constexpr std::uint32_t colorOf(Tone tone, bool dark) {
  const ThemeColor& color = kThemeColors[static_cast<std::size_t>(tone)];
  return dark ? color.dark : color.light;
}

/// RGBA8, red lowest.
constexpr std::uint32_t inkOf(Tone tone, bool dark) {
  const std::uint32_t color = colorOf(tone, dark);
  return 0xff000000U | (color & 0xffU) << 16U | (color & 0xff00U) | color >> 16U;
}

/// All pairs of a text and its background. Their contrast is at least 4.5:1 (WCAG 2.1, 1.4.3).
inline constexpr std::array<std::pair<Tone, Tone>, 19> kTextOn{{{Tone::text, Tone::panel},
                                                                {Tone::text, Tone::field},
                                                                {Tone::text, Tone::fieldHovered},
                                                                {Tone::text, Tone::button},
                                                                {Tone::text, Tone::buttonHovered},
                                                                {Tone::text, Tone::chosen},
                                                                {Tone::text, Tone::header},
                                                                {Tone::text, Tone::headerHovered},
                                                                {Tone::faint, Tone::panel},
                                                                {Tone::faint, Tone::field},
                                                                {Tone::faint, Tone::fieldHovered},
                                                                {Tone::faint, Tone::header},
                                                                {Tone::faint, Tone::headerHovered},
                                                                {Tone::mark, Tone::panel},
                                                                {Tone::mark, Tone::buttonHovered},
                                                                {Tone::mark, Tone::chosen},
                                                                {Tone::error, Tone::panel},
                                                                {Tone::alarmText, Tone::alarm},
                                                                {Tone::alarmText, Tone::alarmButton}}};
/// Opacity of controls that cannot be used now; their text keeps that contrast, too.
inline constexpr float kDisabledOpacity = 0.75F;

inline constexpr std::array<std::pair<std::string_view, bool>, 2> kThemes{{{"dark", true}, {"light", false}}};

}  // namespace palpate
