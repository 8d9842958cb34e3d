#include "engine/cloud/length_unit.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

namespace palpate {

namespace {

constexpr std::array<std::pair<std::string_view, LengthUnit>, 20> kWords{{{"mm", LengthUnit::mm},
                                                                          {"millimeter", LengthUnit::mm},
                                                                          {"millimeters", LengthUnit::mm},
                                                                          {"millimetre", LengthUnit::mm},
                                                                          {"millimetres", LengthUnit::mm},
                                                                          {"cm", LengthUnit::cm},
                                                                          {"centimeter", LengthUnit::cm},
                                                                          {"centimeters", LengthUnit::cm},
                                                                          {"centimetre", LengthUnit::cm},
                                                                          {"centimetres", LengthUnit::cm},
                                                                          {"m", LengthUnit::m},
                                                                          {"meter", LengthUnit::m},
                                                                          {"meters", LengthUnit::m},
                                                                          {"metre", LengthUnit::m},
                                                                          {"metres", LengthUnit::m},
                                                                          {"in", LengthUnit::inch},
                                                                          {"inch", LengthUnit::inch},
                                                                          {"inches", LengthUnit::inch},
                                                                          {"ft", LengthUnit::foot},
                                                                          {"feet", LengthUnit::foot}}};

/// In small letters, without what stands between.
std::vector<std::string> wordsOf(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (std::isalpha(static_cast<unsigned char>(c)))
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!words.back().empty())
      words.emplace_back();
  }
  return words;
}

}  // namespace

std::string_view nameOf(LengthUnit unit) {
  for (const auto& [name, each] : kLengthUnits)
    if (each == unit) return name;
  return "units";
}

LengthUnit unitSaidIn(std::span<const std::string> comments) {
  for (const std::string& comment : comments) {
    const std::vector<std::string> words = wordsOf(comment);
    for (std::size_t i = 1; i < words.size(); ++i)
      for (const auto& [word, unit] : kWords)
        if (words[i] == word && (words[i - 1] == "unit" || words[i - 1] == "units")) return unit;
  }
  return LengthUnit::unknown;
}

double roundLength(double length) {
  if (!(length > 0) || !std::isfinite(length)) return 0;
  const double decade = std::pow(10.0, std::floor(std::log10(length)));
  for (const double factor : {5.0, 2.0})
    if (factor * decade <= length) return factor * decade;
  return decade;
}

}  // namespace palpate
