#include "engine/io/known_formats.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/file_coordinates.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/column_names.hpp"
#include "engine/io/ends_after.hpp"
#include "engine/io/ply_vertices.hpp"
#include "engine/io/ply_writer.hpp"
#include "engine/io/point_batch.hpp"
#include "engine/io/row_output.hpp"
#include "engine/io/text_rows.hpp"

namespace palpate {

namespace {

constexpr std::array<std::string_view, 3> kChannels{"red", "green", "blue"};

/// Double precision for all columns except normals.
PlyElement elementOf(const TextRows& rows) {
  PlyElement element{.name = "vertex", .count = 0, .properties = {}, .line = 1};
  for (const std::string& name : rows.names()) {
    const bool normal = name == "nx" || name == "ny" || name == "nz";
    element.properties.push_back({.name = name, .type = normal ? ScalarType::f32 : ScalarType::f64});
  }
  return element;
}

/// Columns without names, which are stored as attributes until all rows were read.
class UnnamedAttributes {
 public:
  UnnamedAttributes(PointCloud& cloud, std::string name, Log* log)
      : cloud_(cloud), name_(std::move(name)), log_(log), unnamed_(std::move(cloud.extra)) {
    cloud.extra.clear();
  }

  void become(const UnnamedColumns::Layout& layout, bool wholeColors) {
    const std::vector<std::string> names = namesOf(layout);
    for (const UnnamedColumns::Group group : layout) {
      if (group == UnnamedColumns::Group::normal) becomeNormals(threeColumns());
      if (group == UnnamedColumns::Group::color) becomeColors(threeColumns(), wholeColors);
      if (group != UnnamedColumns::Group::scalar) continue;
      unnamed_[next_].name = names[3 + next_];
      cloud_.extra.push_back(std::move(unnamed_[next_++]));
    }
  }

 private:
  std::vector<DVec3> threeColumns() {
    std::vector<DVec3> rows(cloud_.size());
    for (int k = 0; k < 3; ++k, ++next_)
      for (std::size_t i = 0; i < rows.size(); ++i)
        rows[i][k] = loadScalar<double>(unnamed_[next_].data.data() + i * sizeof(double));
    return rows;
  }

  void becomeNormals(const std::vector<DVec3>& rows) {
    std::vector<std::size_t> missing;
    cloud_.normals.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double length = glm::length(rows[i]);
      const bool isThere = length > 0 && std::isfinite(length);
      cloud_.normals[i] = isThere ? Vec3(rows[i] / length) : Vec3(0);
      if (!isThere) missing.push_back(i);
    }
    if (!missing.empty()) fillMissingNormals(cloud_, missing, name_, log_);
  }
  void becomeColors(const std::vector<DVec3>& rows, bool whole) {
    const ColorScale scale = scaleOfColors(rows);
    const double full = scale.full(whole);
    cloud_.storedAs.color = scale.storedAs(whole);
    for (const DVec3& row : rows)
      cloud_.colors.push_back({colorByte(row.x, full), colorByte(row.y, full), colorByte(row.z, full), 255});
  }

  PointCloud& cloud_;
  std::string name_;
  Log* log_;
  std::vector<Attribute> unnamed_;
  std::size_t next_ = 0;
};

template <TextKind kKind>
FileContents contentsOfText(const std::filesystem::path& path) {
  TextRows rows(path, kKind, {});
  FileElement element{.name = "vertex", .count = 0, .properties = {}};
  for (; !rows.words().empty(); rows.next()) ++element.count;
  const bool unnamed = rows.hasUnnamed();
  for (const std::string& name : unnamed ? namesOf(rows.unnamedLayout()) : rows.names())
    element.properties.push_back({.name = name});
  return {.elements = {std::move(element)}, .comments = {}};
}

template <TextKind kKind>
StoredCloud readText(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  TextRows rows(path, kKind, options.columns);
  if (rows.names().empty()) return {};
  const std::string name = path.filename().string();
  if (log) rows.file().onProgress([&](double share) { log->progress(name, share); });
  if (options.normalsFromFaces && log) log->say("{}: has no faces to take normals from", name);
  const PlyElement element = elementOf(rows);
  PlyVertices vertices(path, element, log);
  std::vector<std::byte> packed;
  std::size_t count = 0;
  const auto append = [&] {
    vertices.append(packed.data(), count, false);  // invalid points are left out
    packed.clear();
    count = 0;
  };
  for (; !rows.words().empty(); rows.next()) {
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const double value = rows.number(k);
      visitScalar(element.properties[k].type, [&]<class T>(std::type_identity<T>) {
        const T stored = static_cast<T>(value);
        const auto* bytes = reinterpret_cast<const std::byte*>(&stored);
        packed.insert(packed.end(), bytes, bytes + sizeof(T));
      });
    }
    if (++count == kPointBatch) append();
  }
  append();
  const UnnamedColumns::Layout layout = rows.unnamedLayout();
  if (log && kKind != TextKind::pts && rows.file().endsInLine()) sayOpenLine(name, rows.file().line(), *log);
  if (rows.hasWholeColors()) vertices.countColorSteps();
  StoredCloud stored{.cloud = vertices.finish(log)};
  stored.lost = vertices.lost();
  for (std::string& what : rows.lost()) stored.lost.push_back(std::move(what));
  for (const std::string& words : rows.wordColumns())
    std::erase_if(stored.cloud.extra, [&](const Attribute& attribute) { return attribute.name == words; });
  for (const std::string& remark : rows.remarks())
    if (log) log->say("{}: {}", name, remark);
  if (rows.unit() != LengthUnit::unknown) sayUnit(stored.cloud.storedAs.comments, rows.unit());
  if (!rows.hasUnnamed()) return stored;
  UnnamedAttributes(stored.cloud, name, log).become(layout, rows.hasWholeColors());
  stored.assumed = fmt::format("{}", fmt::join(namesOf(layout), ","));
  if (log) log->say("{}: columns without names are taken as {}; --columns names them otherwise", name, stored.assumed);
  return stored;
}

void report(const CloudWriteOptions& options, std::size_t i, std::size_t points) {
  if (options.progress && i % kBetweenReports == 0)
    options.progress(static_cast<double>(i) / static_cast<double>(points));
}

void writeValue(RowOutput& out, const Attribute& attribute, std::size_t i) {
  visitScalar(attribute.type,
              [&]<class T>(std::type_identity<T>) { out.value(loadScalar<T>(attribute.data.data() + i * sizeof(T))); });
}

void writePlace(RowOutput& out, const TextCoordinates& coordinates, bool wide, std::size_t i) {
  const DVec3 position = coordinates.at(i);
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
  const TextCoordinates coordinates(cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    report(options, i, cloud.size());
    writePlace(out, coordinates, wide, i);
    if (cloud.hasNormals())
      for (int k = 0; k < 3; ++k) out.value(cloud.normals[i][k]);
    if (cloud.hasColors())
      for (std::size_t k = 0; k < kChannels.size(); ++k) out.value(cloud.colors[i][k]);
    for (const Attribute* attribute : extra) writeValue(out, *attribute, i);
    out.endRow();
  }
  out.finish(options.keptAs);
}

/// Also as CloudCompare calls it.
const Attribute* intensityOf(const PointCloud& cloud) {
  for (const std::string_view name : {"intensity", "scalar_intensity"})
    for (const Attribute& attribute : cloud.extra)
      if (sharedColumnName(attribute.name) == name) return &attribute;
  return nullptr;
}

std::vector<const Attribute*> attributesOfPts(const PointCloud& cloud) {
  const Attribute* intensity = intensityOf(cloud);
  return intensity ? std::vector{intensity} : std::vector<const Attribute*>{};
}

/// Colours are preceded by an intensity, 0 if the cloud has none.
void writePts(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  RowOutput out(path, true);
  out.headerLine(fmt::format("{}", cloud.size()));
  const Attribute* intensity = intensityOf(cloud);
  const bool wide = needsDoubles(cloud, options);
  const TextCoordinates coordinates(cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    report(options, i, cloud.size());
    writePlace(out, coordinates, wide, i);
    if (intensity) writeValue(out, *intensity, i);
    if (!intensity && cloud.hasColors()) out.value(0);
    if (cloud.hasColors())
      for (std::size_t k = 0; k < kChannels.size(); ++k) out.value(cloud.colors[i][k]);
    out.endRow();
  }
  out.finish(options.keptAs);
}

std::vector<std::string> lacksOfText(const PointCloud& cloud) {
  std::vector<std::string> lost;
  if (!cloud.storedAs.comments.empty()) lost.emplace_back("comments");
  for (const std::string& name : namesGivingWay(cloud))
    lost.push_back(fmt::format("the column '{}', because another one is written under its name", name));
  if (cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  return lost;
}

std::vector<std::string> lacksOfPts(const PointCloud& cloud) {
  std::vector<std::string> lost;
  if (!cloud.storedAs.comments.empty()) lost.emplace_back("comments");
  if (cloud.hasNormals()) lost.emplace_back("normals");
  for (const Attribute& attribute : cloud.extra)
    if (&attribute != intensityOf(cloud)) lost.push_back(fmt::format("the column '{}'", attribute.name));
  if (cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  return lost;
}

/// Three or more numbers, or column names including x, y and z.
bool beginsAsText(const FileStart& start) {
  if (!start.isText()) return false;
  const auto lines = start.lines(1);
  if (lines.empty()) return false;
  const auto names = [&](std::string_view name) {
    return std::ranges::any_of(lines[0], [&](const std::string& word) { return sharedColumnName(word) == name; });
  };
  if (names("x") && names("y") && names("z")) return true;
  return lines[0].size() >= 3 && std::ranges::all_of(lines[0], isNumberWord);
}

/// The number of points followed by a point, or directly a point.
bool beginsAsPts(const FileStart& start) {
  if (beginsAsText(start)) return true;
  if (!start.isText()) return false;
  const auto lines = start.lines(2);
  return lines.size() == 2 && lines[0].size() == 1 && isNumberWord(lines[0][0]) && lines[1].size() >= 3 &&
         std::ranges::all_of(lines[1], isNumberWord);
}

}  // namespace

CloudFormat xyzFormat() {
  static constexpr std::array<std::string_view, 3> kEndings{".xyz", ".asc", ".txt"};
  return {.name = "XYZ",
          .endings = kEndings,
          .begins = beginsAsText,
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
          .begins = beginsAsText,
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
          .begins = beginsAsPts,
          .isText = true,
          .contents = contentsOfText<TextKind::pts>,
          .read = readText<TextKind::pts>,
          .write = writePts,
          .lacks = lacksOfPts,
          .attributes = attributesOfPts,
          .keepsNormals = false};
}

}  // namespace palpate
