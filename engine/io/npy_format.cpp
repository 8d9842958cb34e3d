#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/npy_array.hpp"
#include "engine/io/npy_writer.hpp"
#include "engine/io/ply_vertices.hpp"
#include "engine/io/point_batch.hpp"
#include "engine/io/zip_archive.hpp"

namespace palpate {

namespace {

constexpr std::array<const char*, 3> kNpyPlaces{"x", "y", "z"}, kNpyNormals{"nx", "ny", "nz"},
    kNpyColors{"red", "green", "blue"};

std::vector<std::byte> readWhole(const std::filesystem::path& path, Log* log) {
  ChunkedFile file(path);
  if (log) file.onProgress([&](double share) { log->progress(path.filename().string(), share); });
  std::vector<std::byte> bytes;
  for (auto piece = file.peek(1); !piece.empty(); piece = file.peek(1)) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    file.consume(piece.size());
  }
  return bytes;
}

/// A column, and the data of its array.
struct Source {
  NpyColumn column;
  std::span<const std::byte> data;
};

/// Columns of equal length, under the names of a cloud's attributes.
class NpyTable {
 public:
  explicit NpyTable(const std::filesystem::path& path) : path_(path) {}

  std::uint64_t rows() const { return rows_; }
  const std::vector<Source>& sources() const { return sources_; }
  std::vector<std::string>& lost() { return lost_; }

  /// Adds the only array.
  void addAlone(const NpyArray& array) {
    rows_ = array.rows;
    const std::size_t begin = sources_.size();
    for (const NpyColumn& column : array.columns) sources_.push_back({column, array.data});
    if (!array.structured) nameColumns(std::span(sources_).subspan(begin), array);
  }

  /// Adds an array of an archive; its name tells its meaning.
  void addNamed(const std::string& name, const NpyArray& array) {
    if (sources_.empty()) rows_ = array.rows;
    const bool perPoint = array.rows == rows_ && !array.shape.empty();
    if (!perPoint) return lost_.push_back(fmt::format("the array {} of shape {}", inQuotes(name), array.shapeText()));
    const std::array<const char*, 3>* three = isPlaces(name)                                         ? &kNpyPlaces
                                              : isOneOf(name, {"normals", "normal"})                 ? &kNpyNormals
                                              : isOneOf(name, {"colors", "colours", "rgb", "color"}) ? &kNpyColors
                                                                                                     : nullptr;
    if (array.columns.size() != 3) three = nullptr;
    for (std::size_t k = 0; k < array.columns.size(); ++k) {
      NpyColumn column = array.columns[k];
      if (!array.structured)
        column.name = three ? (*three)[k] : array.columns.size() == 1 ? name : fmt::format("{}_{}", name, k);
      sources_.push_back({std::move(column), array.data});
    }
  }

  static bool isPlaces(const std::string& name) {
    return isOneOf(name, {"points", "xyz", "positions", "position", "pos", "vertices", "coords"});
  }

  /// Drops columns with duplicate names, and names them as lost.
  void settle() {
    for (std::size_t k = 0; k < sources_.size();) {
      std::string& name = sources_[k].column.name;
      for (char& c : name)
        if (c <= ' ' || c > '~' || c == ',' || c == ';') c = '_';
      const auto before = sources_.begin() + static_cast<std::ptrdiff_t>(k);
      const bool twice =
          std::find_if(sources_.begin(), before, [&](const Source& s) { return s.column.name == name; }) != before;
      if (twice || name.empty()) {
        lost_.push_back(fmt::format("a column {}", inQuotes(name)));
        sources_.erase(before);
      } else {
        ++k;
      }
    }
  }

  PlyElement element() const {
    PlyElement element{.name = "vertex", .count = rows_, .properties = {}, .line = 1};
    for (const Source& source : sources_)
      element.properties.push_back({.name = source.column.name, .type = source.column.type});
    return element;
  }

  /// Also names rows and columns that are lost.
  PointCloud cloud(Log* log) {
    PlyVertices vertices(path_, element(), log);
    vertices.reserve(rows_);
    std::vector<std::byte> packed(kPointBatch * vertices.rowBytes());
    for (std::uint64_t begin = 0; begin < rows_; begin += kPointBatch) {
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kPointBatch, rows_ - begin));
      std::byte* to = packed.data();
      for (std::size_t r = 0; r < count; ++r)
        for (const Source& source : sources_) {
          loadNpy(source.column, source.data, begin + r, to);
          to += sizeOf(source.column.type);
        }
      if (const auto bad = vertices.append(packed.data(), count, false))
        throw FileError(path_, fmt::format("row {}: {}", begin + bad->row, bad->what));
    }
    PointCloud cloud = vertices.finish(log);
    for (std::string& what : vertices.lost()) lost_.push_back(std::move(what));
    return cloud;
  }

 private:
  static bool isOneOf(std::string_view name, std::initializer_list<const char*> names) {
    return std::ranges::find(names, name) != names.end();
  }
  /// Tolerance of one hundredth for rounding; zero vectors and those that are not finite are ignored.
  bool areNormals(std::span<const Source> three) const {
    for (std::uint64_t r = 0; r < rows_; ++r) {
      double squared = 0;
      for (const Source& source : three) squared += std::pow(npyValue(source.column, source.data, r), 2);
      if (squared != 0 && std::isfinite(squared) && !(std::abs(std::sqrt(squared) - 1) < 0.01)) return false;
    }
    return true;
  }

  bool areColors(std::span<const Source> three) const {
    bool shares = true, bytes = true;
    for (const Source& source : three)
      for (std::uint64_t r = 0; r < rows_; ++r) {
        const double value = npyValue(source.column, source.data, r);
        shares = shares && !(value < 0 || value > 1);
        bytes = bytes && !(value < 0 || value > 255 || value != std::trunc(value));
      }
    return shares || bytes;
  }

  void nameColumns(std::span<Source> columns, const NpyArray& array) const {
    const auto name = [&](std::size_t begin, const std::array<const char*, 3>& names) {
      for (std::size_t k = 0; k < 3; ++k) columns[begin + k].column.name = names[k];
    };
    const bool six = columns.size() == 6;
    const bool facing = six && areNormals(columns.subspan(3)),
               colored = six && !facing && areColors(columns.subspan(3));
    if (columns.size() != 3 && columns.size() != 4 && !facing && !colored)
      throw FileError(path_,
                      fmt::format("an array of shape {}, whose columns have no names; (N, 3) are positions, (N, 4) "
                                  "have an intensity, (N, 6) normals or colours, others need names: a structured dtype",
                                  array.shapeText()));
    name(0, kNpyPlaces);
    if (columns.size() == 4) columns[3].column.name = "intensity";
    if (six) name(3, facing ? kNpyNormals : kNpyColors);
  }

  const std::filesystem::path& path_;
  std::uint64_t rows_ = 0;
  std::vector<Source> sources_;
  std::vector<std::string> lost_;
};

/// The bytes of a file, and the table made of them.
struct NpyFile {
  std::vector<std::vector<std::byte>> bytes;
  NpyTable table;
};

NpyFile openNpy(const std::filesystem::path& path, Log* log) {
  NpyFile file{.bytes = {readWhole(path, log)}, .table = NpyTable(path)};
  file.table.addAlone(readNpyArray(path, file.bytes[0], 0));
  file.table.settle();
  return file;
}

struct NamedArray {
  std::string name;
  NpyArray array;
};

/// numpy.savez() names arrays arr_0, arr_1 and so on by default: then the first one contains the positions.
void nameByOrder(std::vector<NamedArray>& arrays) {
  const auto first = std::ranges::find(arrays, "arr_0", &NamedArray::name);
  const bool named = std::ranges::any_of(arrays, [](const NamedArray& one) { return NpyTable::isPlaces(one.name); });
  if (arrays.size() > 1 && !named && first != arrays.end() && first->array.columns.size() == 3) first->name = "points";
}

NpyFile openNpz(const std::filesystem::path& path, Log* log) {
  NpyFile file{.bytes = {}, .table = NpyTable(path)};
  const std::vector<std::byte> archive = readWhole(path, log);
  std::vector<NamedArray> arrays;
  const std::vector<ZipMember> members = zipMembers(path, archive);
  file.bytes.reserve(members.size());
  for (const ZipMember& member : members) {
    if (!member.name.ends_with(".npy")) {
      file.table.lost().push_back(fmt::format("the member {}", inQuotes(member.name)));
      continue;
    }
    file.bytes.push_back(unpackZip(path, archive, member));
    const std::string name = inQuotes(member.name);  // its bytes may be no valid text, which a path must be on Windows
    const std::filesystem::path within = path.string() + "(" + name.substr(1, name.size() - 2) + ")";
    arrays.push_back({member.name.substr(0, member.name.size() - 4), readNpyArray(within, file.bytes.back(), 0)});
  }
  nameByOrder(arrays);
  if (arrays.size() == 1) {
    file.table.addAlone(arrays[0].array);
  } else {
    // The array of positions determines the number of points.
    std::stable_partition(arrays.begin(), arrays.end(),
                          [](const NamedArray& one) { return NpyTable::isPlaces(one.name); });
    for (const NamedArray& one : arrays) file.table.addNamed(one.name, one.array);
  }
  file.table.settle();
  return file;
}

FileContents contentsIn(const NpyFile& file) {
  FileElement vertex{.name = "vertex", .count = file.table.rows(), .properties = {}};
  for (const Source& source : file.table.sources()) vertex.properties.push_back({source.column.name});
  return {.elements = {std::move(vertex)}, .comments = {}};
}

StoredCloud cloudIn(NpyFile file, const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  if (options.normalsFromFaces && log) log->say("{}: has no faces to take normals from", path.filename().string());
  StoredCloud stored{.cloud = file.table.cloud(log)};
  stored.lost = std::move(file.table.lost());
  return stored;
}

}  // namespace

CloudFormat npyFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".npy"};
  return {.name = "NPY",
          .endings = kEndings,
          .begins = [](const FileStart& start) { return start.startsWith("\x93NUMPY"); },
          .contents = [](const std::filesystem::path& path) { return contentsIn(openNpy(path, nullptr)); },
          .read = [](const std::filesystem::path& path, Log* log,
                     const CloudReadOptions& options) { return cloudIn(openNpy(path, log), path, log, options); },
          .write = writeNpy,
          .lacks = lacksOfNpy};
}

CloudFormat npzFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".npz"};
  return {.name = "NPZ",
          .endings = kEndings,
          .begins =
              [](const FileStart& start) {
                return start.startsWith("PK\3\4") && start.bytes.find(".npy") != std::string::npos;
              },
          .contents = [](const std::filesystem::path& path) { return contentsIn(openNpz(path, nullptr)); },
          .read = [](const std::filesystem::path& path, Log* log,
                     const CloudReadOptions& options) { return cloudIn(openNpz(path, log), path, log, options); },
          .write = writeNpz,
          .lacks = lacksOfNpz};
}

}  // namespace palpate
