#include "engine/io/text_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/column_names.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxTextRow = std::size_t{1} << 20;
constexpr std::string_view kHowToName =
    "a line before it should name them, as in: x y z nx ny nz red green blue; or --columns does";

bool isRemark(std::string_view word) { return word.starts_with('#') || word.starts_with("//"); }

/// Missing values as written by spreadsheets and statistics programs.
bool isMissing(std::string_view word) {
  constexpr std::array<std::string_view, 7> kWords{"", "NA", "N/A", "null", "NULL", "None", "none"};
  return std::ranges::find(kWords, word) != kWords.end();
}

bool isNumber(std::string_view word) { return textNumber<double>(word).has_value(); }

/// Names of positions, normals and colours are case-insensitive; all other names are unchanged.
std::vector<std::string> columnNames(const std::vector<std::string_view>& words) {
  constexpr std::array<std::string_view, 10> kKnown{"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"};
  constexpr std::array<std::string_view, 4> kShort{"r", "g", "b", "a"};
  std::vector<std::string> names(words.begin(), words.end()), shared;
  for (std::string& name : names) {
    shared.push_back(sharedColumnName(name));
    std::ranges::replace(name, ' ', '_');  // a blank would split it when written
  }
  const auto has = [&](std::string_view name) { return std::ranges::find(shared, name) != shared.end(); };
  const bool colored = has("r") && has("g") && has("b");  // a single such letter is ambiguous
  for (std::size_t k = 0; k < names.size(); ++k) {
    const bool known = std::ranges::find(kKnown, shared[k]) != kKnown.end() ||
                       (colored && std::ranges::find(kShort, shared[k]) != kShort.end());
    // Of two columns with the same meaning, the one with the exact name is used, else the first one.
    if (known && std::ranges::find(names, shared[k]) == names.end()) names[k] = shared[k];
  }
  return names;
}

bool isColorColumn(const std::string& name) {
  constexpr std::array<std::string_view, 8> kNames{"red", "green", "blue", "alpha", "r", "g", "b", "a"};
  return std::ranges::find(kNames, name) != kNames.end();
}

bool namesColumns(const std::vector<std::string>& names) {
  return std::ranges::all_of(std::array{"x", "y", "z"},
                             [&](const char* name) { return std::ranges::find(names, name) != names.end(); });
}

}  // namespace

void UnnamedColumns::take(std::string_view a, std::string_view b, std::string_view c) {
  constexpr double kUnitTolerance = 0.01;  // tolerance for rounding
  double squared = 0;
  for (const std::string_view word : {a, b, c}) {
    const double value = textNumber<double>(word).value_or(std::numeric_limits<double>::quiet_NaN());
    squared += value * value;
    if (value < 0 || value > 1) shares = false;
    if (value < 0 || value > 255 || value != std::trunc(value)) bytes = false;
    if (word.find_first_of(".eE") != word.npos) whole = false;
  }
  if (!std::isfinite(squared) || squared == 0) return;
  anyNormal = true;
  if (!(std::abs(std::sqrt(squared) - 1) < kUnitTolerance)) normals = false;
}

TextRows::TextRows(const std::filesystem::path& path, TextKind kind, const std::vector<std::string>& columns)
    : file_(path), counted_(kind == TextKind::pts), named_(!columns.empty()) {
  begin();
  if (words_.empty()) {  // no points
    checkEnd();
    return;
  }
  firstLine_ = file_.line();
  if (named_) names_ = columns;
  keepApart();
  countPoint();
  if (names_.empty()) names_ = usualNames();
  checkColumns();
  look();
}

void TextRows::next() {
  do {
    const auto line = file_.readLine(kMaxTextRow);
    words_.clear();
    if (!line) return checkEnd();
    words_.split(*line);
  } while (words_.empty() || isRemark(words().front()) || isCount());
  countPoint();
  checkColumns();
  look();
}

double TextRows::number(std::size_t column) const {
  const std::string_view word = words()[column];
  if (const auto value = textNumber<double>(word)) return *value;
  if (isMissing(word)) return std::numeric_limits<double>::quiet_NaN();
  fail(fmt::format("found {} for '{}', expected a number", inQuotes(word), names_[column]));
}

void TextRows::checkColumns() {
  if (words_.endsOpen() && words().size() + 1 == names_.size()) words_.addEmpty();
  if (words().size() == names_.size()) return;
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

/// For formats with counts: whether the line is the number of points of the next scan.
bool TextRows::isCount() {
  if (!counted_ || words().size() != 1) return false;
  const auto count = textNumber<std::uint64_t>(words().front());
  if (!count) fail(fmt::format("found {}, expected a point, or the number of points", inQuotes(words().front())));
  checkEnd();
  promised_ = *count;
  seen_ = 0;
  return true;
}

void TextRows::countPoint() {
  ++seen_;
  if (promised_ && seen_ > *promised_) fail(fmt::format("more than the {} points that were promised", *promised_));
}

void TextRows::checkEnd() const {
  if (!promised_ || seen_ >= *promised_) return;
  throw FileError::atLine(file_.path(), file_.line(), fmt::format("ends after {} of {} points", seen_, *promised_));
}

/// Advances to the first point, past the line that names the columns.
void TextRows::begin() {
  bool passed = false;  // skipped a line of names that the caller has replaced
  while (const auto line = file_.readLine(kMaxTextRow)) {
    const std::size_t first = line->find_first_not_of(" \t");
    if (first == line->npos) continue;
    const bool remark = isRemark(line->substr(first));
    words_.split(remark ? line->substr(std::min(line->find_first_not_of("#/", first), line->size())) : *line);
    if (words_.empty() || isCount()) continue;
    if (auto names = columnNames(words()); namesColumns(names)) {
      names_ = std::move(names);
    } else if (!remark) {
      const bool isPoint = isNumber(words().front()) || isMissing(words().front());
      if (isPoint) return;
      if (!named_ || passed)
        fail(
            fmt::format("found {}, expected the coordinates of a point, or names of columns with x, y and z among "
                        "them; --columns x,y,z names them in their place",
                        inQuotes(words().front())));
      passed = true;
    }
  }
  words_.clear();
}

std::vector<std::string> TextRows::usualNames() {
  std::vector<std::string> names{"x", "y", "z"};
  const auto add = [&](std::initializer_list<const char*> more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  const std::size_t columns = words().size();
  unnamed_ = columns == 6;
  colorsAt_ = columns == 6 ? 3 : columns == 7 ? 4 : 0;
  if (columns == 4 || columns == 7) add({"intensity"});
  if (columns == 6) add({kUnnamed[0], kUnnamed[1], kUnnamed[2]});
  if (columns == 7) add({"red", "green", "blue"});
  if (names.size() != columns)
    fail(fmt::format("a point of {}, which may mean anything; {}", counted(columns, "column"), kHowToName));
  return names;
}

void TextRows::look() {
  if (colorsAt_ == 0) {
    for (std::size_t k = 0; k < names_.size(); ++k)
      if (looked_.whole && words()[k].find_first_of(".eE") != std::string_view::npos && isColorColumn(names_[k]))
        looked_.whole = false;
    return;
  }
  looked_.take(words()[colorsAt_], words()[colorsAt_ + 1], words()[colorsAt_ + 2]);
  if (!unnamed_ && !looked_.areColors())
    fail(fmt::format("columns 5 to 7 have no names and cannot be colours here; {}", kHowToName));
}

void TextRows::checkUnnamed() const {
  if (!unnamed_ || looked_.areNormals() || looked_.areColors()) return;
  throw FileError::atLine(
      file_.path(), firstLine_,
      fmt::format("columns 4 to 6 have no names, and are neither unit normals nor colours throughout; {}", kHowToName));
}

}  // namespace palpate
