// Numbers in text files of people and programs.
#pragma once

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace palpate {

/// from_chars does not set the value on range errors: too small becomes zero, too large infinite.
template <class T>
T beyondRange(std::string_view text) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (stop && error == std::errc{}) return static_cast<T>(value);
  const std::size_t exponent = text.find_first_of("eE");
  const bool tiny = exponent != text.npos ? text.substr(exponent + 1).starts_with('-') : text.find('.') <= 1;
  return tiny ? T{0} : std::copysign(std::numeric_limits<T>::infinity(), text[0] == '-' ? T{-1} : T{1});
}

/// Parses NaN and infinity as Windows programs wrote them before 2015: 1.#INF, -1.#IND00, 1.#QNAN, and rounded to few
/// digits as 1.#J or 1.#R, which counts as NaN.
template <class T>
std::optional<T> oldWindowsNumber(std::string_view text) {
  const bool isNegative = text.starts_with('-');
  if (!text.substr(isNegative).starts_with("1.#")) return std::nullopt;
  if (text.find("#INF") == text.npos) return std::numeric_limits<T>::quiet_NaN();
  return std::copysign(std::numeric_limits<T>::infinity(), isNegative ? T{-1} : T{1});
}

/// All of `text` as one number, optionally with a plus sign; nothing if it is invalid, or an integer is out of range.
template <class T>
std::optional<T> textNumber(std::string_view text) {
  if (text.size() > 1 && text[0] == '+') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  T value{};
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop == end && !text.empty()) {
    if (error == std::errc{}) return value;
    if constexpr (std::is_floating_point_v<T>) return beyondRange<T>(text);
  } else if constexpr (std::is_integral_v<T>) {
    // Some programs write integers as 255.0.
    double real = 0;
    const auto [realStop, realError] = std::from_chars(text.data(), end, real);
    constexpr double kLow = std::numeric_limits<T>::min(), kHigh = static_cast<double>(std::numeric_limits<T>::max());
    if (realStop == end && realError == std::errc{} && real == std::trunc(real) && real >= kLow && real < kHigh + 1)
      return static_cast<T>(real);
  }
  if constexpr (std::is_floating_point_v<T>) return oldWindowsNumber<T>(text);
  return std::nullopt;
}

}  // namespace palpate
