#include "engine/io/las_unit.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace palpate {

namespace {

constexpr std::string_view kProjection = "LASF_Projection";
constexpr unsigned kTextRecord = 2112, kKeysRecord = 34735, kNamesRecord = 34737;

std::string_view wordsIn(const LasRecord& record) {
  return {reinterpret_cast<const char*>(record.data.data()), record.data.size()};
}

LengthUnit unitOfMetres(double metres) {
  constexpr double kInternational = 1e-5;  // the US survey foot is 2e-6 longer than the international foot
  for (const auto& [unit, size] : {std::pair{LengthUnit::m, 1.0},
                                   {LengthUnit::foot, 0.3048},
                                   {LengthUnit::cm, 0.01},
                                   {LengthUnit::mm, 0.001},
                                   {LengthUnit::inch, 0.0254}})
    if (std::abs(metres / size - 1) < kInternational) return unit;
  return LengthUnit::unknown;
}

/// The text in the brackets behind the first of the words that occurs.
std::optional<std::string_view> insideOf(std::string_view text, std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words) {
    const std::size_t begin = text.find(word);
    if (begin == text.npos) continue;
    std::size_t depth = 0;
    for (std::size_t i = begin; i < text.size(); ++i) {
      if (text[i] == '[') ++depth;
      if (text[i] == ']' && --depth == 0) return text.substr(begin + word.size(), i - begin - word.size());
    }
  }
  return std::nullopt;
}

/// The last unit of length in a projected system is that of its axes; units of parameters come first.
LengthUnit unitInText(std::string_view text) {
  auto projected = insideOf(text, {"PROJCS[", "PROJCRS[", "PROJECTEDCRS["});
  if (!projected) {
    const bool degrees = insideOf(text, {"GEOGCS[", "GEOGCRS[", "GEOGRAPHICCRS["}).has_value();
    return degrees ? LengthUnit::unknown : LengthUnit::m;  // local or geocentric system
  }
  // Some programs nest the vertical system.
  projected = projected->substr(
      0, std::min({projected->find("VERTCS["), projected->find("VERT_CS["), projected->find("VERTCRS[")}));
  LengthUnit unit = LengthUnit::m;
  for (std::size_t at = 0; (at = projected->find("UNIT[", at)) != projected->npos; at += 5) {
    const std::string_view before = projected->substr(0, at);
    if (before.ends_with("ANGLE") || before.ends_with("SCALE")) continue;
    const std::size_t comma = projected->find(',', at);
    double metres = 0;
    const char* const end = projected->data() + projected->size();
    if (comma == projected->npos) break;
    std::from_chars(std::find_if(projected->data() + comma + 1, end, [](char c) { return c != ' '; }), end, metres);
    constexpr double kDegree = 0.0174532925;  // of a nested geographic system, in WKT 1
    if (std::abs(metres / kDegree - 1) > 1e-6) unit = unitOfMetres(metres);
  }
  return unit;
}

LengthUnit unitInKeys(std::span<const std::byte> data, std::string_view names) {
  constexpr unsigned kModel = 1024, kProjected = 3072, kLinearUnits = 3076;
  constexpr unsigned kGeographic = 2, kMetre = 9001, kFoot = 9002, kSurveyFoot = 9003;
  constexpr unsigned kFirstInFeet = 2222, kLastInFeet = 2289;  // NAD83 state planes in EPSG's list
  LengthUnit unit = LengthUnit::m;
  if (names.find("ftUS") != names.npos || names.find("foot") != names.npos || names.find("feet") != names.npos)
    unit = LengthUnit::foot;
  std::optional<LengthUnit> said;
  constexpr std::size_t kKey = 8;
  for (std::size_t at = kKey; at + kKey <= data.size(); at += kKey) {
    const unsigned key = loadScalar<std::uint16_t>(data.data() + at);
    const unsigned value = loadScalar<std::uint16_t>(data.data() + at + 6);
    if (key == kModel && value == kGeographic) return LengthUnit::unknown;
    if (key == kProjected && value >= kFirstInFeet && value <= kLastInFeet) unit = LengthUnit::foot;
    if (key == kLinearUnits)
      said = value == kMetre                          ? LengthUnit::m
             : value == kFoot || value == kSurveyFoot ? LengthUnit::foot
                                                      : LengthUnit::unknown;
  }
  return said.value_or(unit);
}

}  // namespace

LengthUnit lasUnit(std::span<const LasRecord> records) {
  std::string_view names;
  for (const LasRecord& record : records) {
    if (record.is(kProjection, kTextRecord)) return unitInText(wordsIn(record));
    if (record.is(kProjection, kNamesRecord)) names = wordsIn(record);
  }
  for (const LasRecord& record : records)
    if (record.is(kProjection, kKeysRecord)) return unitInKeys(record.data, names);
  return LengthUnit::unknown;
}

}  // namespace palpate
