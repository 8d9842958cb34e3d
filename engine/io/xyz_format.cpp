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
#include "engine/io/row_output.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kLongestLine = std::size_t{1} << 20;
constexpr std::size_t kBatch = 4096;  // rows
constexpr std::string_view kBetween = " \t,;\r\v\f";
constexpr std::array<std::string_view, 3> kChannels{"red", "green", "blue"};

using Words = std::vector<std::string_view>;

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

std::vector<std::string> lowerCase(const Words& words) {
  std::vector<std::string> names(words.begin(), words.end());
  for (std::string& name : names)
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return names;
}

bool namesColumns(const std::vector<std::string>& names) {
  return std::ranges::all_of(std::array{"x", "y", "z"},
                             [&](const char* name) { return std::ranges::find(names, name) != names.end(); });
}

/// Walks over the lines that hold points.
class XyzRows {
 public:
  explicit XyzRows(const std::filesystem::path& path) : file_(path) {
    begin();
    if (words_.empty()) return;  // no point at all
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
      const auto line = file_.readLine(kLongestLine);
      words_.clear();
      if (!line) return;
      split(*line, words_);
    } while (words_.empty() || isRemark(words_.front()));
    if (words_.size() != names_.size())
      fail(fmt::format("a point of {} columns where those before have {}", words_.size(), names_.size()));
  }

 private:
  static bool isRemark(std::string_view word) { return word.starts_with('#') || word.starts_with("//"); }

  // To the first point, past the line that names the columns.
  void begin() {
    while (const auto line = file_.readLine(kLongestLine)) {
      const std::size_t first = line->find_first_not_of(kBetween);
      if (first == line->npos) continue;
      const bool remark = isRemark(line->substr(first));
      split(line->substr(remark ? std::min(line->find_first_not_of("#/", first), line->size()) : first), words_);
      if (auto names = lowerCase(words_); namesColumns(names)) {
        names_ = std::move(names);
      } else if (!remark) {
        if (!isNumber(words_.front()))
          fail(fmt::format("found {}, expected the coordinates of a point, or names of columns with x, y and z among them",
                           inQuotes(words_.front())));
        return;
      }
    }
    words_.clear();
  }

  std::vector<std::string> usualNames() const {
    std::vector<std::string> names{"x", "y", "z"};
    const auto add = [&](std::initializer_list<const char*> more) { names.insert(names.end(), more.begin(), more.end()); };
    const bool facing = words_.size() == 6 && isUnit(words_[3], words_[4], words_[5]);
    const bool colored = words_.size() == 6 && !facing && std::all_of(words_.begin() + 3, words_.end(), isChannel);
    if (words_.size() == 4) add({"intensity"});
    if (colored) add({"red", "green", "blue"});
    if (facing) add({"nx", "ny", "nz"});
    if (names.size() != words_.size())
      fail(fmt::format("a point of {} columns, which may mean anything; a line before it should name them, as in: x y z "
                       "nx ny nz red green blue",
                       words_.size()));
    return names;
  }

  ChunkedFile file_;
  std::vector<std::string> names_;
  Words words_;
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
    element.properties.push_back(
        {.name = name, .type = byte ? ScalarType::u8 : normal ? ScalarType::f32 : ScalarType::f64});
  }
  return element;
}

FileContents contentsOfXyz(const std::filesystem::path& path) {
  XyzRows rows(path);
  FileElement element{.name = "vertex", .count = 0, .properties = {}};
  for (const std::string& name : rows.names()) element.properties.push_back({.name = name});
  for (; !rows.words().empty(); rows.next()) ++element.count;
  return {.elements = {std::move(element)}, .comments = {}};
}

StoredCloud readXyz(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  XyzRows rows(path);
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
    if (lines.size() == kBatch) append();
  }
  append();
  return {.cloud = vertices.finish(log)};
}

/// Those whose names are not taken by normals and colours.
std::vector<const Attribute*> attributesBeside(const PointCloud& cloud) {
  const std::vector<std::string> taken = namesGivingWay(cloud);
  std::vector<const Attribute*> attributes;
  for (const Attribute& attribute : cloud.extra)
    if (std::ranges::find(taken, attribute.name) == taken.end()) attributes.push_back(&attribute);
  return attributes;
}

void writeXyz(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  RowOutput out(path, true);
  std::string names = "x y z";
  if (cloud.hasNormals()) names += " nx ny nz";
  if (cloud.hasColors())
    for (const std::string_view channel : kChannels) names += fmt::format(" {}", channel);
  const std::vector<const Attribute*> extra = attributesBeside(cloud);
  for (const Attribute* attribute : extra) names += fmt::format(" {}", attribute->name);
  if (names.size() > std::string_view("x y z").size()) out.headerLine(names);
  const bool wide =
      options.doubles || cloud.storedAs.position == ScalarType::f64 || cloud.origin != DVec3(0) || !cloud.exactPositions.empty();
  constexpr std::size_t kBetweenReports = 1 << 16;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (options.progress && i % kBetweenReports == 0)
      options.progress(static_cast<double>(i) / static_cast<double>(cloud.size()));
    const DVec3 position = cloud.fileCoordinates(i);
    for (int k = 0; k < 3; ++k) out.real(wide ? ScalarType::f64 : ScalarType::f32, position[k]);
    if (cloud.hasNormals())
      for (int k = 0; k < 3; ++k) out.value(cloud.normals[i][k]);
    if (cloud.hasColors())
      for (std::size_t k = 0; k < kChannels.size(); ++k) out.value(cloud.colors[i][k]);
    for (const Attribute* attribute : extra)
      visitScalar(attribute->type, [&]<class T>(std::type_identity<T>) {
        out.value(loadScalar<T>(attribute->data.data() + i * sizeof(T)));
      });
    out.endRow();
  }
  out.finish(options.keptAs);
}

std::vector<std::string> lacksOfXyz(const StoredCloud& stored) {
  std::vector<std::string> lost;
  if (!stored.triangles.empty()) lost.push_back(fmt::format("{} triangles", stored.triangles.size()));
  if (!stored.cloud.storedAs.comments.empty()) lost.emplace_back("comments");
  for (const std::string& name : namesGivingWay(stored.cloud))
    lost.push_back(fmt::format("the column '{}', for the one that is written under its name", name));
  if (stored.cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  return lost;
}

}  // namespace

CloudFormat xyzFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".xyz"};
  return {.name = "XYZ",
          .endings = kEndings,
          .contents = contentsOfXyz,
          .read = readXyz,
          .write = writeXyz,
          .lacks = lacksOfXyz};
}

}  // namespace palpate
