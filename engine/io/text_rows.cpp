#include "engine/io/text_rows.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "engine/core/counted.hpp"
#include "engine/io/column_names.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxTextRow = std::size_t{1} << 20;
constexpr std::string_view kHowToName =
    "a line before it should name them, as in: x y z nx ny nz red green blue; or --columns does (palpate info FILE "
    "--columns ? shows the first rows)";

bool isRemark(std::string_view word) { return word.starts_with('#') || word.starts_with("//"); }

/// Missing values as written by spreadsheets and statistics programs.
bool isMissing(std::string_view word) {
  constexpr std::array<std::string_view, 9> kWords{"", "NA", "N/A", "#N/A", "-", "null", "NULL", "None", "none"};
  return std::ranges::find(kWords, word) != kWords.end();
}

bool isNumber(std::string_view word) { return textNumber<double>(word).has_value(); }

/// Whether it is a colour as on the web: #rrggbb.
bool isHexColor(std::string_view word) {
  return word.size() == 7 && word[0] == '#' && word.find_first_not_of("0123456789abcdefABCDEF", 1) == word.npos;
}

constexpr std::array<std::string_view, 10> kKnown{"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"};

/// Names of positions, normals and colours are case-insensitive; all other names are unchanged.
std::vector<std::string> columnNames(const std::vector<std::string_view>& words) {
  constexpr std::array<std::string_view, 4> kShort{"r", "g", "b", "a"};
  std::vector<std::string> names, shared;
  for (const std::string_view word : words) {
    std::string& name = names.emplace_back(utf8Name(word));
    shared.push_back(sharedColumnName(name));
    std::ranges::replace(name, ' ', '_');  // a blank would split it when written
  }
  const auto has = [&](std::string_view name) { return std::ranges::find(shared, name) != shared.end(); };
  nameShortAxes(shared);
  const bool colored = has("r") && has("g") && has("b");  // a single such letter is ambiguous
  for (std::size_t k = 0; k < names.size(); ++k) {
    const bool known = std::ranges::find(kKnown, shared[k]) != kKnown.end() ||
                       (colored && std::ranges::find(kShort, shared[k]) != kShort.end());
    // Of two columns with the same meaning, the one with the exact name is used, else the first one.
    if (known && std::ranges::find(names, shared[k]) == names.end()) names[k] = shared[k];
  }
  return names;
}

double millimetresPer(LengthUnit unit) {
  constexpr std::array<std::pair<LengthUnit, double>, 5> kLengths{{{LengthUnit::mm, 1},
                                                                   {LengthUnit::cm, 10},
                                                                   {LengthUnit::m, 1000},
                                                                   {LengthUnit::inch, 25.4},
                                                                   {LengthUnit::foot, 304.8}}};
  const auto found = std::ranges::find(kLengths, unit, &std::pair<LengthUnit, double>::first);
  return found == kLengths.end() ? 0 : found->second;
}

/// Whether a whole number is not exact in double precision.
bool isRounded(std::string_view word, double value) {
  constexpr double kWhole = 9007199254740992;  // 2^53
  return std::abs(value) > kWhole && word.find_first_not_of("+-0123456789") == word.npos;
}

bool isColorColumn(const std::string& name) {
  constexpr std::array<std::string_view, 8> kNames{"red", "green", "blue", "alpha", "r", "g", "b", "a"};
  return std::ranges::find(kNames, name) != kNames.end();
}

bool hasName(const std::vector<std::string>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

bool namesColumns(const std::vector<std::string>& names) {
  return hasName(names, "x") && hasName(names, "y") && hasName(names, "z");
}

/// Whether these are latitude and longitude.
bool nameDegrees(const std::vector<std::string_view>& words) {
  bool latitude = false, longitude = false;
  for (const std::string_view word : words) {
    const std::string name = sharedColumnName(word);
    latitude = latitude || name == "lat" || name.starts_with("latitude") || name.starts_with("lat_");
    longitude = longitude || name == "lon" || name == "lng" || name == "long" || name.starts_with("longitude") ||
                name.starts_with("lon_") || name.starts_with("long_");
  }
  return latitude && longitude;
}

/// The line `sep=;` by which Excel learns the separator.
bool isSeparatorLine(std::string_view line) {
  return line.size() >= 5 && line.size() <= 7 && (line.starts_with("sep=") || line.starts_with("\"sep="));
}

}  // namespace

TextRows::TextRows(const std::filesystem::path& path, TextKind kind, const std::vector<std::string>& columns)
    : file_(path), names_(columns), kind_(kind), named_(!columns.empty()) {
  begin();
  if (words_.empty()) {  // no points
    checkEnd();
    return;
  }
  firstLine_ = file_.line();
  keepApart();
  countPoint();
  if (names_.empty()) {
    names_ = usualNames();
  } else {
    findHexColor();
  }
  wordsIn_.resize(names_.size());
  checkColumns();
  look();
}

void TextRows::next() {
  do {
    const auto line = file_.readLine(kMaxTextRow);
    words_.clear();
    row_.clear();
    if (!line) return checkEnd();
    words_.split(*line);
  } while (words_.empty() || (isRemark(words_.words().front()) && !(hexAt_ == 0 && isHexRow())) || isCount());
  countPoint();
  checkColumns();
  look();
}

double TextRows::number(std::size_t column) {
  const std::string_view word = words()[column];
  if (const auto value = textNumber<double>(word)) {
    if (word.size() > 15 && isRounded(word, *value)) ++wordsIn_[column].rounded;
    for (const Scaled& scaled : scaled_)
      if (scaled.column == column) return *value * scaled.times / scaled.per;
    return *value;
  }
  if (!isMissing(word)) {
    if (unnamed_ || std::ranges::find(kKnown, names_[column]) != kKnown.end() || isColorColumn(names_[column]))
      fail(fmt::format("found {} for '{}', expected a number", inQuotes(word), names_[column]));
    WordsIn& in = wordsIn_[column];
    if (++in.count == 1) in.line = file_.line(), in.first = word;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> TextRows::wordColumns() const {
  std::vector<std::string> only;
  for (std::size_t k = 0; k < wordsIn_.size(); ++k)
    if (wordsIn_[k].count > 0 && wordsIn_[k].count == points_) only.push_back(names_[k]);
  return only;
}

std::vector<std::string> TextRows::lost() const {
  std::vector<std::string> lost;
  if (titles_ > (named_ ? 1 : 0)) lost.push_back(counted(titles_, "title line"));
  for (std::size_t k = 0; k < wordsIn_.size(); ++k)
    if (const WordsIn& in = wordsIn_[k]; in.rounded > 0)
      lost.push_back(fmt::format("the last digits of {} in the column '{}', which are beyond 2^53",
                                 counted(in.rounded, "whole number"), names_[k]));
    else if (in.count > 0)
      lost.push_back(in.count == points_
                         ? fmt::format("the column '{}', which has words like {}", names_[k], inQuotes(in.first))
                         : fmt::format("{} in the column '{}', which count as missing (line {}: {})",
                                       counted(in.count, "word"), names_[k], in.line, inQuotes(in.first)));
  return lost;
}

void TextRows::checkColumns() {
  spreadHexColor();
  const auto fits = [&] { return words().size() == names_.size(); };
  if (const std::string& number = words_.contradiction(); !number.empty())
    fail(
        fmt::format("found '{}' where the commas of other numbers {}; write decimal points, and nothing between "
                    "thousands",
                    number, words_.hasDecimalCommas() ? "may be decimal ones" : "stand between thousands"));
  if (words_.endsOpen() && words().size() + 1 == names_.size()) words_.addEmpty();
  if (!fits() && words_.cutAtMarks()) spreadHexColor();  // words of several parts
  if (fits()) return;
  const bool twice = words().size() == 2 * names_.size() && !words_.hasDecimalCommas();
  fail(fmt::format("a point of {}{} {}{}{}", counted(words().size(), "column"),
                   seen_ > 1 ? " where those before have" : ", of which", names_.size(), seen_ > 1 ? "" : " have names",
                   twice ? "; if its commas are decimal ones, write points, or blanks between the numbers" : ""));
}

/// A duplicate name becomes NAME_2.
void TextRows::keepApart() {
  for (auto name = names_.begin(); name != names_.end(); ++name) {
    const std::string first = *name;
    for (int number = 2; std::find(names_.begin(), name, *name) != name; ++number)
      *name = fmt::format("{}_{}", first, number);
  }
}

/// Finds a named column of colours as on the web, which then has the names of three.
void TextRows::findHexColor() {
  const auto& words = words_.words();
  const auto hex = std::ranges::find_if(words, isHexColor);
  if (hex == words.end() || words.size() != names_.size() || hasName(names_, "red")) return;
  hexAt_ = static_cast<std::size_t>(hex - words.begin());
  const auto at = names_.erase(names_.begin() + (hex - words.begin()));
  names_.insert(at, {"red", "green", "blue"});
}

void TextRows::spreadHexColor() {
  if (!hexAt_) return;
  row_ = words_.words();
  if (*hexAt_ >= row_.size()) return;
  const std::string_view hex = row_[*hexAt_];
  if (!isHexColor(hex) && !isMissing(hex)) fail(fmt::format("found {}, expected a colour like #ff8000", inQuotes(hex)));
  for (std::size_t k = 0; k < 3; ++k) {
    unsigned value = 0;
    hexWords_[k].clear();
    if (!isHexColor(hex)) continue;
    std::from_chars(hex.data() + 1 + 2 * k, hex.data() + 3 + 2 * k, value, 16);
    hexWords_[k] = fmt::format("{}", value);
  }
  const auto at = row_.erase(row_.begin() + static_cast<std::ptrdiff_t>(*hexAt_));
  row_.insert(at, hexWords_.begin(), hexWords_.end());
}

/// For formats with counts: whether the line is the number of points of the next scan.
bool TextRows::isCount() {
  if (kind_ != TextKind::pts || words_.words().size() != 1) return false;
  const std::string_view word = words_.words().front();
  const auto count = textNumber<std::uint64_t>(word);
  if (!count) fail(fmt::format("found {}, expected a point, or the number of points", inQuotes(word)));
  checkEnd();
  promised_ = *count;
  seen_ = 0;
  return true;
}

void TextRows::countPoint() {
  ++points_;
  ++seen_;
  if (promised_ && seen_ > *promised_) fail(fmt::format("more than the {} points that were promised", *promised_));
}

void TextRows::checkEnd() const {
  if (words_.hasAmbiguousCommas())
    throw FileError::atLine(file_.path(), firstLine_,
                            "commas that may be decimal ones or stand between thousands; write points, or no commas");
  if (!promised_ || seen_ >= *promised_) return;
  throw FileError::atLine(file_.path(), file_.line(), fmt::format("ends after {} of {} points", seen_, *promised_));
}

/// Whether a row of words is a colour as on the web and a point.
bool TextRows::isHexRow() const {
  const auto& words = words_.words();
  return words.size() >= 4 && isHexColor(words[0]) && isNumber(words[1]) && isNumber(words[2]) && isNumber(words[3]);
}

bool TextRows::isPoint() const {
  const auto& words = words_.words();
  const auto isValue = [&](std::size_t k) { return isNumber(words[k]) || isMissing(words[k]); };
  if (words.size() != names_.size() || names_.empty()) return isValue(0);
  for (std::size_t k = 0; k < names_.size(); ++k)
    if ((names_[k] == "x" || names_[k] == "y" || names_[k] == "z") && !isValue(k)) return false;
  return true;
}

/// Takes the names of columns if they include x, y and z.
bool TextRows::takeNames(std::vector<std::string_view> words) {
  // Units may be separate words: X [m] Y [m] Z [m].
  std::erase_if(words, [](std::string_view word) { return word.starts_with('[') || word.starts_with('('); });
  auto names = columnNames(words);
  if (!namesColumns(names)) {
    if (!named_ && nameDegrees(words))
      fail("contains latitudes and longitudes in degrees, not lengths. Project it first, for example to UTM");
    return false;
  }
  if (named_) return true;
  names_ = std::move(names);
  unit_ = LengthUnit::unknown;
  std::array<LengthUnit, 3> units{};
  for (std::size_t k = 0; k < words.size(); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (names_[k] == std::array{"x", "y", "z"}[axis]) units[axis] = unitInName(words[k]);
  if (std::ranges::find(units, LengthUnit::unknown) == units.end()) useUnits(units);
  return true;
}

/// Lengths of all axes become those of the x axis.
void TextRows::useUnits(const std::array<LengthUnit, 3>& units) {
  unit_ = units[0];
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (units[axis] == unit_) continue;
    const std::string_view name = std::array{"x", "y", "z"}[axis];
    const auto column = static_cast<std::size_t>(std::ranges::find(names_, name) - names_.begin());
    scaled_.push_back({.column = column, .times = millimetresPer(units[axis]), .per = millimetresPer(unit_)});
    remarks_.push_back(fmt::format("{} is in {} and x in {}; {} is scaled to {}", name, nameOf(units[axis]),
                                   nameOf(unit_), name, nameOf(unit_)));
  }
}

/// Advances to the first point, past titles and the line that names the columns.
void TextRows::begin() {
  constexpr std::uint64_t kMaxTitles = 20;
  std::uint64_t titleLine = 0;
  std::string title;
  std::size_t titleWords = 0;
  const auto refuseTitle = [&] {
    const std::string expected =
        names_.empty() ? "the coordinates of a point, or names of columns with x, y and z among them; --columns x,y,z "
                         "names them in their place"
                       : fmt::format("a point of the columns {}", fmt::join(names_, ","));
    throw FileError::atLine(file_.path(), titleLine, fmt::format("found {}, expected {}", inQuotes(title), expected));
  };
  while (const auto line = file_.readLine(kMaxTextRow)) {
    const std::size_t first = line->find_first_not_of(" \t");
    if (first == line->npos || (titles_ == 0 && isSeparatorLine(*line))) continue;
    const bool remark = isRemark(line->substr(first));
    words_.split(*line);
    if (remark && isHexRow()) return;
    if (remark) words_.split(line->substr(std::min(line->find_first_not_of("#/", first), line->size())));
    if (words_.empty() || isCount() || takeNames(words_.words()) || remark) continue;
    // Words of several parts, as in "2024-01-01 10:00:00,1,2,3".
    if (!names_.empty() && words_.words().size() != names_.size() && words_.cutAtMarks() &&
        words_.words().size() != names_.size())
      words_.split(*line);
    if (isPoint()) {
      // A line of as many words as the points have columns names them, but not x, y and z.
      if (names_.empty() && titles_ > 0 && titleWords == words_.words().size()) refuseTitle();
      return;
    }
    titleLine = file_.line();
    title = words_.words().front();
    titleWords = words_.words().size();
    if (++titles_ > kMaxTitles || (!named_ && !names_.empty())) refuseTitle();
  }
  if (titles_ > 0) refuseTitle();
  words_.clear();
}

std::vector<std::string> TextRows::usualNames() {
  const auto& words = words_.words();
  const std::size_t columns = words.size();
  std::vector<std::string> names{"x", "y", "z"};
  if (columns == 4 && (isHexColor(words[0]) || isHexColor(words[3]))) {
    hexAt_ = isHexColor(words[0]) ? 0 : 3;
    names.insert(names.begin() + static_cast<std::ptrdiff_t>(*hexAt_), {"red", "green", "blue"});
    return names;
  }
  for (std::size_t k = 0; k < columns; ++k)
    if (!isNumber(words[k]) && !isMissing(words[k]))
      fail(
          fmt::format("column {} of a point without names has words like {}; of a survey --columns number,y,x,z,code "
                      "or the like names them; {}",
                      k + 1, inQuotes(words[k]), kHowToName));
  if (columns == 3) return names;
  unnamed_.emplace(columns, kind_ == TextKind::pts);
  if (!unnamed_->isPossible())
    fail(fmt::format("a point of {}, which may mean anything; {}", counted(columns, "column"), kHowToName));
  for (std::size_t k = 4; k <= columns; ++k) names.push_back(fmt::format("column_{}", k));
  return names;
}

void TextRows::look() {
  if (unnamed_) unnamed_->take(words());
  for (std::size_t k = 0; wholeColors_ && k < names_.size(); ++k)
    if (isColorColumn(names_[k]) && words()[k].find_first_of(".eE") != std::string_view::npos) wholeColors_ = false;
}

UnnamedColumns::Layout TextRows::unnamedLayout() const {
  if (!unnamed_) return {};
  std::string why;
  auto layout = unnamed_->layout(why);
  if (layout.empty()) throw FileError::atLine(file_.path(), firstLine_, fmt::format("{}; {}", why, kHowToName));
  return layout;
}

}  // namespace palpate
