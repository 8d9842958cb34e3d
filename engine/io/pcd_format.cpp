#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/ends_after.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/lzf.hpp"
#include "engine/io/pcd_header.hpp"
#include "engine/io/ply_writer.hpp"
#include "engine/io/point_batch.hpp"
#include "engine/io/row_output.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxPcdRow = std::size_t{1} << 20;
constexpr std::string_view kViewpoint = "comment viewpoint: ", kNoViewpoint = "0 0 0 1 0 0 0";

class PcdBody {
 public:
  PcdBody(ChunkedFile& file, const PcdHeader& header, Log* log)
      : file_(file), header_(header), rowBytes_(header.rowBytes()), rows_(file.path(), header, log) {}

  PcdRows& read() {
    if (header_.data == PcdData::ascii) readText();
    if (header_.data == PcdData::binary) readBinary();
    if (header_.data == PcdData::compressed) readCompressed();
    return rows_;
  }

 private:
  [[noreturn]] void failAt(std::uint64_t byte, std::string_view what) const {
    throw FileError::atByte(file_.path(), byte, what);
  }

  void readBinary() {
    if (const auto there = file_.remaining(); there && header_.points > *there / rowBytes_)
      throw endsAfter(file_.path(), file_.offset() + *there, *there / rowBytes_, header_.points, "points");
    if (file_.remaining()) rows_.reserve(header_.points);
    for (std::uint64_t done = 0; done < header_.points;) {
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kPointBatch, header_.points - done));
      const auto bytes = file_.peek(count * rowBytes_);
      if (bytes.size() < count * rowBytes_)
        failAt(file_.offset() + bytes.size(),
               fmt::format("the file ends inside point {} of {}", done + bytes.size() / rowBytes_ + 1, header_.points));
      if (const auto bad = rows_.append(bytes.data(), count)) failAt(file_.offset() + bad->row * rowBytes_, bad->what);
      file_.consume(count * rowBytes_);
      done += count;
    }
  }

  void readCompressed() {
    const std::uint64_t at = file_.offset();
    const auto sizes = file_.peek(8);
    if (sizes.size() < 8) failAt(at + sizes.size(), "the file ends before its compressed points");
    const std::size_t packed = loadScalar<std::uint32_t>(sizes.data()),
                      whole = loadScalar<std::uint32_t>(sizes.data() + 4);
    file_.consume(8);
    if (header_.points > whole || header_.points * rowBytes_ != whole)
      failAt(at + 4,
             fmt::format("{} bytes of points, where {} of {} bytes are promised", whole, header_.points, rowBytes_));
    const auto bytes = file_.peek(packed);
    if (bytes.size() < packed)
      failAt(file_.offset() + bytes.size(), fmt::format("the file ends inside its {} compressed bytes", packed));
    if (whole / kMaxPerLzfByte > packed)
      failAt(at, fmt::format("{} compressed bytes cannot become {} bytes", packed, whole));
    std::vector<std::byte> columns(whole);
    if (const auto bad = unpackLzf(bytes.first(packed), columns))
      failAt(file_.offset() + *bad, "damaged compressed points");
    appendColumns(columns);
  }

  /// Columns are stored field by field: all values of the first field, then all of the next one.
  void appendColumns(const std::vector<std::byte>& columns) {
    std::vector<std::byte> rows;
    for (std::size_t begin = 0; begin < header_.points; begin += kPointBatch) {
      const std::size_t count = std::min<std::size_t>(kPointBatch, header_.points - begin);
      rows.resize(count * rowBytes_);
      std::size_t field = 0, to = 0;
      for (const PcdField& one : header_.fields) {
        const std::size_t bytes = one.bytes * one.count;
        for (std::size_t r = 0; r < count; ++r)
          std::memcpy(rows.data() + r * rowBytes_ + to, columns.data() + field + (begin + r) * bytes, bytes);
        field += header_.points * bytes;
        to += bytes;
      }
      if (const auto bad = rows_.append(rows.data(), count))
        throw FileError(file_.path(), fmt::format("point {}: {}", begin + bad->row + 1, bad->what));
    }
  }

  void readText() {
    std::vector<std::byte> rows;
    std::vector<std::uint64_t> lines;
    const auto append = [&] {
      if (const auto bad = rows_.append(rows.data(), lines.size()))
        throw FileError::atLine(file_.path(), lines[bad->row], bad->what);
      rows.clear();
      lines.clear();
    };
    std::uint64_t points = 0;
    while (const auto line = file_.readLine(kMaxPcdRow)) {
      if (line->find_first_not_of(" \t") == line->npos) continue;
      if (points++ == header_.points)
        throw FileError::atLine(file_.path(), file_.line(),
                                fmt::format("more than the {} points of the header", header_.points));
      appendLine(*line, rows);
      lines.push_back(file_.line());
      if (lines.size() == kPointBatch) append();
    }
    append();
    if (points < header_.points)
      throw FileError::atLine(file_.path(), file_.line() + 1,
                              fmt::format("the file ends after {} of {} points", points, header_.points));
  }

  void appendLine(std::string_view line, std::vector<std::byte>& rows) const {
    std::size_t at = 0;
    for (const PcdField& field : header_.fields)
      for (std::size_t k = 0; k < field.count; ++k) {
        const std::size_t begin = std::min(line.find_first_not_of(" \t", at), line.size());
        at = std::min(line.find_first_of(" \t", begin), line.size());
        const std::string_view word = line.substr(begin, at - begin);
        if (field.name == "_") {
          rows.resize(rows.size() + field.bytes);
          continue;
        }
        visitPcd(field, [&]<class T>(std::type_identity<T>) {
          const auto value = textNumber<T>(word);
          if (!value)
            throw file_.errorInLine(
                fmt::format("found {} for {}, expected a number", inQuotes(word), inQuotes(field.name)));
          const auto* bytes = reinterpret_cast<const std::byte*>(&*value);
          rows.insert(rows.end(), bytes, bytes + sizeof(T));
        });
      }
    if (line.find_first_not_of(" \t", at) != line.npos)
      throw file_.errorInLine("a point of more numbers than the header has fields");
  }

  ChunkedFile& file_;
  const PcdHeader& header_;
  std::size_t rowBytes_;
  PcdRows rows_;
};

FileContents contentsOfPcd(const std::filesystem::path& path) {
  ChunkedFile file(path);
  const PcdHeader header = readPcdHeader(file);
  FileElement vertex{.name = "vertex", .count = header.points, .properties = {}};
  for (const PlyProperty& property : PcdRows::elementOf(header).properties)
    vertex.properties.push_back({property.name});
  return {.elements = {std::move(vertex)}, .comments = header.comments};
}

StoredCloud readPcd(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  ChunkedFile file(path);
  const std::string name = path.filename().string();
  if (log) file.onProgress([&](double share) { log->progress(name, share); });
  if (options.normalsFromFaces && log) log->say("{}: has no faces to take normals from", name);
  const PcdHeader header = readPcdHeader(file);
  PcdBody body(file, header, log);
  PcdRows& rows = body.read();
  StoredCloud stored{.cloud = rows.finish(log)};
  stored.cloud.storedAs.comments = header.comments;
  if (!header.viewpoint.empty() && header.viewpoint != kNoViewpoint)
    stored.cloud.storedAs.comments.push_back(std::string(kViewpoint) + header.viewpoint);
  stored.lost = rows.lost();
  if (header.height > 1) stored.lost.push_back(fmt::format("the grid of {} x {}", header.width, header.height));
  return stored;
}

bool fieldGivesWay(const PointCloud& cloud, const std::string& name) {
  const std::vector<std::string> taken = namesGivingWay(cloud);
  return std::ranges::find(taken, name) != taken.end() || (cloud.hasNormals() && name.starts_with("normal_")) ||
         (cloud.hasColors() && (name == "rgb" || name == "rgba"));
}

std::string headerOf(const PointCloud& cloud, bool wide, const std::vector<const Attribute*>& extra, bool ascii) {
  std::string names = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT", remarks, viewpoint(kNoViewpoint);
  const auto add = [&](std::string_view name, ScalarType type) {
    names += fmt::format(" {}", name);
    sizes += fmt::format(" {}", sizeOf(type));
    const bool isSigned =
        type == ScalarType::i8 || type == ScalarType::i16 || type == ScalarType::i32 || type == ScalarType::i64;
    types += isFloating(type) ? " F" : isSigned ? " I" : " U";
    counts += " 1";
  };
  for (const char* name : {"x", "y", "z"}) add(name, wide ? ScalarType::f64 : ScalarType::f32);
  if (cloud.hasNormals())
    for (const char* name : {"normal_x", "normal_y", "normal_z"}) add(name, ScalarType::f32);
  if (cloud.hasColors()) add(cloud.storedAs.alpha ? "rgba" : "rgb", ScalarType::u32);
  for (const Attribute* attribute : extra) add(attribute->name, attribute->type);
  for (const std::string& comment : cloud.storedAs.comments) {
    if (comment.starts_with(kViewpoint))
      viewpoint = comment.substr(kViewpoint.size());
    else
      remarks += "# " + (comment.starts_with("comment ") ? comment.substr(8) : comment) + '\n';
  }
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\n{}VERSION 0.7\n{}\n{}\n{}\n{}\nWIDTH {}\nHEIGHT 1\n"
      "VIEWPOINT {}\nPOINTS {}\nDATA {}",
      remarks, names, sizes, types, counts, cloud.size(), viewpoint, cloud.size(), ascii ? "ascii" : "binary");
}

void writePcd(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  std::vector<const Attribute*> extra;
  for (const Attribute& attribute : cloud.extra)
    if (!fieldGivesWay(cloud, attribute.name)) extra.push_back(&attribute);
  const bool wide = needsDoubles(cloud, options);
  RowOutput out(path, options.ascii);
  out.headerLine(headerOf(cloud, wide, extra, options.ascii));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (options.progress && i % kBetweenReports == 0)
      options.progress(static_cast<double>(i) / static_cast<double>(cloud.size()));
    const DVec3 position = cloud.fileCoordinates(i);
    for (int k = 0; k < 3; ++k) out.real(wide ? ScalarType::f64 : ScalarType::f32, position[k]);
    if (cloud.hasNormals())
      for (int k = 0; k < 3; ++k) out.value(cloud.normals[i][k]);
    if (cloud.hasColors()) {
      const std::array<std::uint8_t, 4>& color = cloud.colors[i];
      const std::uint32_t alpha = cloud.storedAs.alpha ? color[3] : 0u;
      out.value(alpha << 24 | std::uint32_t{color[0]} << 16 | std::uint32_t{color[1]} << 8 | color[2]);
    }
    for (const Attribute* attribute : extra)
      visitScalar(attribute->type, [&]<class T>(std::type_identity<T>) {
        out.value(loadScalar<T>(attribute->data.data() + i * sizeof(T)));
      });
    out.endRow();
  }
  out.finish(options.keptAs);
}

std::vector<const Attribute*> attributesOfPcd(const PointCloud& cloud) {
  std::vector<const Attribute*> attributes;
  for (const Attribute& attribute : cloud.extra)
    if (!fieldGivesWay(cloud, attribute.name)) attributes.push_back(&attribute);
  return attributes;
}

std::vector<std::string> lacksOfPcd(const PointCloud& cloud) {
  std::vector<std::string> lost;
  for (const Attribute& attribute : cloud.extra)
    if (fieldGivesWay(cloud, attribute.name))
      lost.push_back(fmt::format("the field '{}', because another one is written under its name", attribute.name));
  return lost;
}

}  // namespace

CloudFormat pcdFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".pcd"};
  return {.name = "PCD",
          .endings = kEndings,
          .begins =
              [](const FileStart& start) {
                return start.startsWith("# .PCD") ||
                       (start.startsWith("VERSION") && start.bytes.find("\nFIELDS") != std::string::npos);
              },
          .contents = contentsOfPcd,
          .read = readPcd,
          .write = writePcd,
          .lacks = lacksOfPcd,
          .attributes = attributesOfPcd,
          .hasComments = true};
}

}  // namespace palpate
