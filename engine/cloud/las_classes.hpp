// The standard classes of LAS 1.4 (ASPRS), by number.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace palpate {

inline constexpr std::string_view kClassification = "classification";  ///< the field that has them

inline constexpr std::array<std::string_view, 19> kLasClasses{
    "never classified",  "unclassified",    "ground",    "low vegetation",
    "medium vegetation", "high vegetation", "building",  "low noise",
    "model key point",   "water",           "rail",      "road surface",
    "overlap",           "wire guard",      "wire",      "transmission tower",
    "wire connector",    "bridge deck",     "high noise"};

/// "2 ground", or "64" for a class without a standard name.
inline std::string lasClassText(double number) {
  const bool isStandard = number >= 0 && number < static_cast<double>(kLasClasses.size());
  constexpr double kLargest = 9e18;  // of 64 bits
  std::string text = std::to_string(static_cast<long long>(std::clamp(number, -kLargest, kLargest)));
  return isStandard ? text + ' ' + std::string(kLasClasses[static_cast<std::size_t>(number)]) : text;
}

}  // namespace palpate
