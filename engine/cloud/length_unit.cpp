#include "engine/cloud/length_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>

namespace palpate {

namespace {

constexpr std::string_view kScaleComment = "comment mm_per_unit: ", kTouchScaleComment = "comment touch_scale: ";

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

/// Splits into words of letters, in lower case.
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

LengthUnit unitInWords(std::string_view comment) {
  const std::vector<std::string> words = wordsOf(comment);
  for (std::size_t i = 1; i < words.size(); ++i)
    for (const auto& [word, unit] : kWords)
      if (words[i] == word && (words[i - 1] == "unit" || words[i - 1] == "units")) return unit;
  return LengthUnit::unknown;
}

constexpr std::array<std::pair<double, LengthUnit>, 5> kMmPerUnit{{{1, LengthUnit::mm},
                                                                   {10, LengthUnit::cm},
                                                                   {1000, LengthUnit::m},
                                                                   {25.4, LengthUnit::inch},
                                                                   {304.8, LengthUnit::foot}}};

}  // namespace

std::string_view nameOf(LengthUnit unit) {
  for (const auto& [name, each] : kLengthUnits)
    if (each == unit) return name;
  return "units";
}

LengthUnit unitOfScale(double mm_per_unit) {
  constexpr double kRounded = 1e-9;  // of the length
  for (const auto& [mm, unit] : kMmPerUnit)
    if (std::abs(mm_per_unit / mm - 1) < kRounded) return unit;
  return LengthUnit::unknown;
}

std::optional<double> mmIn(LengthUnit unit) {
  for (const auto& [mm, each] : kMmPerUnit)
    if (each == unit) return mm;
  return std::nullopt;
}

LengthUnit unitSaidIn(std::span<const std::string> comments) {
  for (const std::string& comment : comments)
    if (const LengthUnit unit = unitInWords(comment); unit != LengthUnit::unknown) return unit;
  const std::optional<double> scale = scaleSaidIn(comments);
  return scale ? unitOfScale(*scale) : LengthUnit::unknown;
}

void setUnit(std::vector<std::string>& comments, LengthUnit unit) {
  std::erase_if(comments, [](const std::string& comment) { return unitInWords(comment) != LengthUnit::unknown; });
  comments.push_back(fmt::format("comment units: {}", nameOf(unit)));
}

void sayUnit(std::vector<std::string>& comments, LengthUnit unit) {
  const auto saysUnit = [](const std::string& comment) { return unitInWords(comment) != LengthUnit::unknown; };
  if (unit == LengthUnit::unknown || std::ranges::any_of(comments, saysUnit)) return;
  comments.push_back(fmt::format("comment units: {}", nameOf(unit)));
}

namespace {

std::optional<double> positiveSaidIn(std::span<const std::string> comments, std::string_view beginning) {
  for (const std::string& comment : comments) {
    if (!comment.starts_with(beginning)) continue;
    const char* const end = comment.data() + comment.size();
    double mm_per_unit = 0;
    const auto [last, error] = std::from_chars(comment.data() + beginning.size(), end, mm_per_unit);
    if (error == std::errc() && last == end && mm_per_unit > 0 && std::isfinite(mm_per_unit)) return mm_per_unit;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> scaleSaidIn(std::span<const std::string> comments) {
  return positiveSaidIn(comments, kScaleComment);
}

std::optional<double> touchScaleSaidIn(std::span<const std::string> comments) {
  return positiveSaidIn(comments, kTouchScaleComment);
}

void setTouchScale(std::vector<std::string>& comments, double mm_per_unit) {
  std::erase_if(comments, [](const std::string& comment) { return comment.starts_with(kTouchScaleComment); });
  comments.push_back(fmt::format("{}{}", kTouchScaleComment, mm_per_unit));
}

void sayScale(std::vector<std::string>& comments, double mm_per_unit) {
  std::erase_if(comments, [](const std::string& comment) {
    return comment.starts_with(kScaleComment) || comment.starts_with(kTouchScaleComment);
  });
  comments.push_back(fmt::format("{}{}", kScaleComment, mm_per_unit));
}

double roundLength(double length) {
  if (!(length > 0) || !std::isfinite(length)) return 0;
  const double decade = std::pow(10.0, std::floor(std::log10(length)));
  for (const double factor : {5.0, 2.0})
    if (factor * decade <= length) return factor * decade;
  return decade;
}

}  // namespace palpate
