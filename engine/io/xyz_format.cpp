#include "engine/io/xyz_format.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <optional>

#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/ply_vertices.hpp"
#include "engine/io/ply_writer.hpp"
#include "engine/io/point_batch.hpp"
#include "engine/io/row_output.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxTextRow = std::size_t{1} << 20;
constexpr std::string_view kBetween = " \t,;\r\v\f";
constexpr std::array<std::string_view, 3> kChannels{"red", "green", "blue"};

using Words = std::vector<std::string_view>;

enum class TextKind { xyz, csv, pts };

/// What programs call normals besides.
std::string sharedColumnName(std::string name) {
  for (const char axis : {'x', 'y', 'z'})
    if (name == fmt::format("normal_{}", axis) || name == fmt::format("normal{}", axis))
      return fmt::format("n{}", axis);
  return name;
}

void split(std::string_view line, Words& words) {
  words.clear();
  for (std::size_t begin = line.find_first_not_of(kBetween); begin != line.npos;
       begin = line.find_first_not_of(kBetween, begin)) {
    const std::size_t end = std::min(line.find_first_of(kBetween, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
}

bool isNumber(std::string_view word) { return textNumber<double>(word).has_value(); }

bool isChannel(std::string_view word) {
  return word.find('.') == word.npos && textNumber<std::uint8_t>(word).has_value();
}

/// To a hundredth, as programs round.
bool isUnit(std::string_view x, std::string_view y, std::string_view z) {
  const auto squared = [](std::string_view word) {
    const double value = textNumber<double>(word).value_or(0);
    return value * value;
  };
  return std::abs(std::sqrt(squared(x) + squared(y) + squared(z)) - 1) < 0.01;
}

std::string lowerCase(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

/// Places, normals and colours are known in whatever case they are written; all other names keep theirs.
std::vector<std::string> columnNames(const Words& words) {
  constexpr std::array<std::string_view, 10> kKnown{"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"};
  constexpr std::array<std::string_view, 4> kShort{"r", "g", "b", "a"};
  std::vector<std::string> names(words.begin(), words.end()), lower;
  for (std::string& name : names) {
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    lower.push_back(sharedColumnName(lowerCase(name)));
  }
  const auto has = [&](std::string_view name) { return std::ranges::find(lower, name) != lower.end(); };
  const bool colored = has("r") && has("g") && has("b");  // alone such a letter means anything
  for (std::size_t k = 0; k < names.size(); ++k)
    if (std::ranges::find(kKnown, lower[k]) != kKnown.end() ||
        (colored && std::ranges::find(kShort, lower[k]) != kShort.end()))
      names[k] = lower[k];
  return names;
}

bool namesColumns(const std::vector<std::string>& names) {
  return std::ranges::all_of(std::array{"x", "y", "z"},
                             [&](const char* name) { return std::ranges::find(names, name) != names.end(); });
}

/// Walks over the lines that hold points.
class XyzRows {
 public:
  XyzRows(const std::filesystem::path& path, TextKind kind, const std::vector<std::string>& columns)
      : file_(path), counted_(kind == TextKind::pts) {
    begin();
    if (words_.empty()) {  // no point at all
      checkEnd();
      return;
    }
    if (!columns.empty()) names_ = columns;
    keepApart();
    countPoint();
    if (names_.empty()) names_ = usualNames();
    if (names_.size() != words_.size())
      fail(fmt::format("a point of {} columns, of which {} have names", words_.size(), names_.size()));
  }

  [[noreturn]] void fail(std::string_view what) const { throw FileError::atLine(file_.path(), file_.line(), what); }

  ChunkedFile& file() { return file_; }
  const std::vector<std::string>& names() const { return names_; }
  /// Of the present point; empty after the last.
  const Words& words() const { return words_; }
  void next() {
    do {
      const auto line = file_.readLine(kMaxTextRow);
      words_.clear();
      if (!line) return checkEnd();
      split(*line, words_);
    } while (words_.empty() || isRemark(words_.front()) || isCount());
    if (words_.size() != names_.size())
      fail(fmt::format("a point of {} columns where those before have {}", words_.size(), names_.size()));
    countPoint();
  }

 private:
  /// The second of a name is NAME_2.
  void keepApart() {
    for (auto name = names_.begin(); name != names_.end(); ++name) {
      const std::string first = *name;
      for (int number = 2; std::find(names_.begin(), name, *name) != name; ++number)
        *name = fmt::format("{}_{}", first, number);
    }
  }
  static bool isRemark(std::string_view word) { return word.starts_with('#') || word.starts_with("//"); }

  /// Of files that have it: the number of points of the scan that follows.
  bool isCount() {
    if (!counted_ || words_.size() != 1) return false;
    const auto count = textNumber<std::uint64_t>(words_.front());
    if (!count) fail(fmt::format("found {}, expected a point, or how many follow", inQuotes(words_.front())));
    checkEnd();
    promised_ = *count;
    seen_ = 0;
    return true;
  }
  void countPoint() {
    ++seen_;
    if (promised_ && seen_ > *promised_) fail(fmt::format("more than the {} points that were promised", *promised_));
  }
  void checkEnd() const {
    if (promised_ && seen_ < *promised_) fail(fmt::format("ends after {} of {} points", seen_, *promised_));
  }

  // To the first point, past the line that names the columns.
  void begin() {
    while (const auto line = file_.readLine(kMaxTextRow)) {
      const std::size_t first = line->find_first_not_of(kBetween);
      if (first == line->npos) continue;
      const bool remark = isRemark(line->substr(first));
      split(line->substr(remark ? std::min(line->find_first_not_of("#/", first), line->size()) : first), words_);
      if (isCount()) continue;
      if (auto names = columnNames(words_); namesColumns(names)) {
        names_ = std::move(names);
      } else if (!remark) {
        if (!isNumber(words_.front()))
          fail(fmt::format(
              "found {}, expected the coordinates of a point, or names of columns with x, y and z among them",
              inQuotes(words_.front())));
        return;
      }
    }
    words_.clear();
  }

  std::vector<std::string> usualNames() const {
    std::vector<std::string> names{"x", "y", "z"};
    const auto add = [&](std::initializer_list<const char*> more) {
      names.insert(names.end(), more.begin(), more.end());
    };
    const bool facing = words_.size() == 6 && isUnit(words_[3], words_[4], words_[5]);
    const bool colored = words_.size() == 6 && !facing && std::all_of(words_.begin() + 3, words_.end(), isChannel);
    const bool lit = words_.size() == 7 && std::all_of(words_.begin() + 4, words_.end(), isChannel);
    if (words_.size() == 4 || lit) add({"intensity"});
    if (colored || lit) add({"red", "green", "blue"});
    if (facing) add({"nx", "ny", "nz"});
    if (names.size() != words_.size())
      fail(
          fmt::format("a point of {} columns, which may mean anything; a line before it should name them, as in: x y z "
                      "nx ny nz red green blue",
                      words_.size()));
    return names;
  }

  ChunkedFile file_;
  std::vector<std::string> names_;
  Words words_;
  bool counted_;  // lines say how many points follow
  std::optional<std::uint64_t> promised_;
  std::uint64_t seen_ = 0;
};

bool isColor(const std::string& name) {
  constexpr std::array<std::string_view, 8> kNames{"red", "green", "blue", "alpha", "r", "g", "b", "a"};
  return std::ranges::find(kNames, name) != kNames.end();
}

/// Colours are bytes where the first point has whole ones, all else is as exact as text can be.
PlyElement elementOf(const XyzRows& rows) {
  PlyElement element{.name = "vertex", .count = 0, .properties = {}, .line = 1};
  for (std::size_t k = 0; k < rows.names().size(); ++k) {
    const std::string& name = rows.names()[k];
    const bool byte = isColor(name) && k < rows.words().size() && isChannel(rows.words()[k]);
    const bool normal = name == "nx" || name == "ny" || name == "nz";
    element.properties.push_back({.name = name,
                                  .type = byte     ? ScalarType::u8
                                          : normal ? ScalarType::f32
                                                   : ScalarType::f64});
  }
  return element;
}

template <TextKind kKind>
FileContents contentsOfText(const std::filesystem::path& path) {
  XyzRows rows(path, kKind, {});
  FileElement element{.name = "vertex", .count = 0, .properties = {}};
  for (const std::string& name : rows.names()) element.properties.push_back({.name = name});
  for (; !rows.words().empty(); rows.next()) ++element.count;
  return {.elements = {std::move(element)}, .comments = {}};
}

template <TextKind kKind>
StoredCloud readText(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  XyzRows rows(path, kKind, options.columns);
  if (rows.names().empty()) return {};
  if (log) rows.file().onProgress([&](double share) { log->progress(path.filename().string(), share); });
  if (options.normalsFromFaces && log) log->say("{}: has no faces to take normals from", path.filename().string());
  const PlyElement element = elementOf(rows);
  PlyVertices vertices(path, element, log);
  std::vector<std::byte> packed;
  std::vector<std::uint64_t> lines;
  const auto append = [&] {
    if (const auto bad = vertices.append(packed.data(), lines.size(), false))
      throw FileError::atLine(path, lines[bad->row], bad->what);
    packed.clear();
    lines.clear();
  };
  for (; !rows.words().empty(); rows.next()) {
    lines.push_back(rows.file().line());
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      visitScalar(property.type, [&]<class T>(std::type_identity<T>) {
        const auto value = textNumber<T>(rows.words()[k]);
        if (!value)
          rows.fail(fmt::format("found {} for '{}', expected a number{}", inQuotes(rows.words()[k]), property.name,
                                property.type == ScalarType::u8 ? " from 0 to 255, as the first point has" : ""));
        const auto* bytes = reinterpret_cast<const std::byte*>(&*value);
        packed.insert(packed.end(), bytes, bytes + sizeof(T));
      });
    }
    if (lines.size() == kPointBatch) append();
  }
  append();
  return {.cloud = vertices.finish(log)};
}

void report(const CloudWriteOptions& options, std::size_t i, std::size_t points) {
  if (options.progress && i % kBetweenReports == 0)
    options.progress(static_cast<double>(i) / static_cast<double>(points));
}

void writeValue(RowOutput& out, const Attribute& attribute, std::size_t i) {
  visitScalar(attribute.type,
              [&]<class T>(std::type_identity<T>) { out.value(loadScalar<T>(attribute.data.data() + i * sizeof(T))); });
}

void writePlace(RowOutput& out, const PointCloud& cloud, bool wide, std::size_t i) {
  const DVec3 position = cloud.fileCoordinates(i);
  for (int k = 0; k < 3; ++k) out.real(wide ? ScalarType::f64 : ScalarType::f32, position[k]);
}

template <TextKind kKind>
void writeText(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  constexpr char kBetweenNumbers = kKind == TextKind::csv ? ',' : ' ';
  RowOutput out(path, true, kBetweenNumbers);
  std::string names = "x y z";
  if (cloud.hasNormals()) names += " nx ny nz";
  if (cloud.hasColors())
    for (const std::string_view channel : kChannels) names += fmt::format(" {}", channel);
  const std::vector<const Attribute*> extra = attributesBeside(cloud);
  for (const Attribute* attribute : extra) names += fmt::format(" {}", attribute->name);
  std::ranges::replace(names, ' ', kBetweenNumbers);
  if (kKind == TextKind::csv || names.size() > std::string_view("x y z").size()) out.headerLine(names);
  const bool wide = needsDoubles(cloud, options);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    report(options, i, cloud.size());
    writePlace(out, cloud, wide, i);
    if (cloud.hasNormals())
      for (int k = 0; k < 3; ++k) out.value(cloud.normals[i][k]);
    if (cloud.hasColors())
      for (std::size_t k = 0; k < kChannels.size(); ++k) out.value(cloud.colors[i][k]);
    for (const Attribute* attribute : extra) writeValue(out, *attribute, i);
    out.endRow();
  }
  out.finish(options.keptAs);
}

const Attribute* intensityOf(const PointCloud& cloud) {
  const auto found = std::ranges::find(cloud.extra, "intensity", &Attribute::name);
  return found == cloud.extra.end() ? nullptr : &*found;
}

/// Where there are colours there is an intensity before them, 0 where the cloud has none.
void writePts(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  RowOutput out(path, true);
  out.headerLine(fmt::format("{}", cloud.size()));
  const Attribute* intensity = intensityOf(cloud);
  const bool wide = needsDoubles(cloud, options);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    report(options, i, cloud.size());
    writePlace(out, cloud, wide, i);
    if (intensity) writeValue(out, *intensity, i);
    if (!intensity && cloud.hasColors()) out.value(0);
    if (cloud.hasColors())
      for (std::size_t k = 0; k < kChannels.size(); ++k) out.value(cloud.colors[i][k]);
    out.endRow();
  }
  out.finish(options.keptAs);
}

std::vector<std::string> lacksOfText(const StoredCloud& stored) {
  std::vector<std::string> lost;
  if (!stored.triangles.empty()) lost.push_back(fmt::format("{} triangles", stored.triangles.size()));
  if (!stored.cloud.storedAs.comments.empty()) lost.emplace_back("comments");
  for (const std::string& name : namesGivingWay(stored.cloud))
    lost.push_back(fmt::format("the column '{}', for the one that is written under its name", name));
  if (stored.cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  return lost;
}

std::vector<std::string> lacksOfPts(const StoredCloud& stored) {
  std::vector<std::string> lost;
  if (!stored.triangles.empty()) lost.push_back(fmt::format("{} triangles", stored.triangles.size()));
  if (!stored.cloud.storedAs.comments.empty()) lost.emplace_back("comments");
  if (stored.cloud.hasNormals()) lost.emplace_back("normals");
  for (const Attribute& attribute : stored.cloud.extra)
    if (&attribute != intensityOf(stored.cloud)) lost.push_back(fmt::format("the column '{}'", attribute.name));
  if (stored.cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  return lost;
}

}  // namespace

CloudFormat xyzFormat() {
  static constexpr std::array<std::string_view, 3> kEndings{".xyz", ".asc", ".txt"};
  return {.name = "XYZ",
          .endings = kEndings,
          .isText = true,
          .contents = contentsOfText<TextKind::xyz>,
          .read = readText<TextKind::xyz>,
          .write = writeText<TextKind::xyz>,
          .lacks = lacksOfText};
}

CloudFormat csvFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".csv"};
  return {.name = "CSV",
          .endings = kEndings,
          .isText = true,
          .contents = contentsOfText<TextKind::csv>,
          .read = readText<TextKind::csv>,
          .write = writeText<TextKind::csv>,
          .lacks = lacksOfText};
}

CloudFormat ptsFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".pts"};
  return {.name = "PTS",
          .endings = kEndings,
          .isText = true,
          .contents = contentsOfText<TextKind::pts>,
          .read = readText<TextKind::pts>,
          .write = writePts,
          .lacks = lacksOfPts};
}

}  // namespace palpate
