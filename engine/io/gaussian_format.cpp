#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "engine/cloud/edited_gaussians.hpp"
#include "engine/cloud/gaussian_columns.hpp"
#include "engine/cloud/gaussian_records.hpp"
#include "engine/core/error.hpp"
#include "engine/core/point_lock.hpp"
#include "engine/io/gaussian_cloud.hpp"
#include "engine/io/gaussian_writer.hpp"
#include "engine/io/ply_body.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_row_sink.hpp"

namespace palpate {

namespace {

// Collects the rows of a PLY file of Gaussians.

bool hasScalar(const PlyElement& vertex, std::string_view name) {
  return std::ranges::any_of(vertex.properties,
                             [&](const PlyProperty& property) { return !property.isList && property.name == name; });
}

/// Columns: those that GaussianRecords requires, and any others.
class GaussianRows final : public PlyRowSink {
 public:
  /// Whether the rows are meant as Gaussians, even if incomplete.
  static bool areGaussians(const PlyElement& vertex) {
    return hasScalar(vertex, "scale_0") && hasScalar(vertex, "rot_0");
  }

  /// Throws FileError at the element's line if a property is missing or has an integer type.
  GaussianRows(const std::filesystem::path& file, const PlyElement& vertex) {
    for (const PlyProperty& property : vertex.properties) {
      if (property.isList) {
        lists_.push_back(property.name);
        continue;
      }
      columns_.push_back({property.name, property.type, rowBytes_});
      rowBytes_ += sizeOf(property.type);
    }
    const auto require = [&](const std::string& name) {
      const auto column = std::ranges::find(columns_, name, &GaussianRecords::Column::name);
      if (column == columns_.end())
        throw FileError::atLine(
            file, vertex.line,
            fmt::format("the vertex element has scale_0 and rot_0, as Gaussians have, but no scalar "
                        "property '{}'; Gaussians have x y z, f_dc_0 to 2, opacity, scale_0 to 2 and "
                        "rot_0 to 3",
                        name));
      if (!isFloating(column->type))
        throw FileError::atLine(file, vertex.line,
                                fmt::format("property '{}' of Gaussians is of type {}; expected float or double", name,
                                            plyName(column->type)));
    };
    const auto requireAll = [&](int count, std::string_view name) {
      for (int k = 0; k < count; ++k) require(fmt::format("{}{}", name, k));
    };
    require("x"), require("y"), require("z");
    requireAll(3, "f_dc_");
    require("opacity");
    requireAll(hasScalar(vertex, "scale_2") ? 3 : 2, "scale_");
    requireAll(4, "rot_");
  }

  std::size_t rowBytes() const override { return rowBytes_; }
  std::size_t bytesAtOnce() const override { return std::size_t{64} << 20; }
  void reserve(std::uint64_t promised) override {
    constexpr std::uint64_t kMax_bytes = std::uint64_t{1} << 35;  // a sparse file may be long without containing data
    rows_.reserve(static_cast<std::size_t>(std::min(promised, kMax_bytes / rowBytes_)) * rowBytes_);
  }

  std::optional<BadRow> append(const std::byte* rows, std::size_t count, bool swapBytes) override {
    const std::size_t begin = rows_.size();
    rows_.insert(rows_.end(), rows, rows + count * rowBytes_);
    for (std::size_t i = 0; swapBytes && i < count; ++i)
      for (const GaussianRecords::Column& column : columns_) {
        const auto value = rows_.begin() + static_cast<std::ptrdiff_t>(begin + i * rowBytes_ + column.offset);
        std::reverse(value, value + static_cast<std::ptrdiff_t>(sizeOf(column.type)));
      }
    return std::nullopt;
  }

  /// All rows, bit by bit.
  std::shared_ptr<const GaussianRecords> takeRecords() {
    return std::make_shared<const GaussianRecords>(std::move(columns_), std::move(rows_));
  }
  /// Lists of each Gaussian, which are not read.
  const std::vector<std::string>& lists() const { return lists_; }

 private:
  std::vector<GaussianRecords::Column> columns_;
  std::size_t rowBytes_ = 0;
  BareVector<std::byte> rows_;
  std::vector<std::string> lists_;
};

std::size_t restsOf(const PlyElement& vertex) {
  return static_cast<std::size_t>(std::ranges::count_if(
      vertex.properties, [](const PlyProperty& property) { return property.name.starts_with(kRestName); }));
}

bool holdsGaussians(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  try {
    const PlyInfo info = readPlyInfo(path);
    const PlyElement* vertex = info.find("vertex");
    return vertex && GaussianRows::areGaussians(*vertex);
  } catch (const FileError&) {  // the reader reports the error
    return false;
  }
}

FileContents contentsOfGaussians(const std::filesystem::path& file) {
  const PlyInfo info = readPlyInfo(file);
  FileContents contents{.elements = {}, .comments = info.comments};
  for (const PlyElement& element : info.elements) {
    const bool gaussians = element.name == "vertex";
    FileElement& known = contents.elements.emplace_back();
    known.name = gaussians ? "Gaussian" : element.name;
    known.count = element.count;
    for (const PlyProperty& property : element.properties) known.properties.push_back({property.name, property.isList});
    if (gaussians)
      contents.madeFrom = fmt::format("a splat scene of {}; the points are those of their surface",
                                      gaussiansInWords(element.count, restsOf(element)));
  }
  return contents;
}

std::vector<std::string> lostOf(const PlyInfo& info, const GaussianRows& rows) {
  std::vector<std::string> lost;
  for (const PlyElement& element : info.elements)
    if (element.count > 0 && element.name != "vertex")
      lost.push_back(fmt::format("{} {}", element.count, element.name));
  for (const std::string& name : rows.lists()) lost.push_back(fmt::format("property '{}' of vertex", name));
  return lost;
}

StoredCloud readGaussians(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  const std::string name = path.filename().string();
  ChunkedFile file(path);
  if (log) file.onProgress([&](double share) { log->progress(name, share); });
  const PlyInfo info = readPlyHeader(file);
  const PlyElement* vertex = info.find("vertex");
  if (!vertex) throw FileError::atLine(path, file.line(), "no element 'vertex'");
  GaussianRows rows(path, *vertex);
  readPlyBody(file, info, rows, nullptr, log);
  if (log && options.normalsFromFaces) log->say("{}: has no faces to take normals from", name);

  std::vector<std::string> lost = lostOf(info, rows);
  auto records = rows.takeRecords();
  StoredCloud stored = surfaceOfGaussians(name, sceneOf(*records), log);
  stored.lost = std::move(lost);  // Gaussians that are not felt are kept with the others
  stored.cloud.storedAs.baggage = std::move(records);
  stored.cloud.storedAs.comments = info.comments;
  addPointBytes(stored.cloud, kLockField);
  return stored;
}

}  // namespace

CloudFormat gaussianFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".3dgs.ply"};
  return {.name = "3DGS",
          .endings = kEndings,
          .holds = holdsGaussians,
          .contents = contentsOfGaussians,
          .read = readGaussians,
          .write = writeGaussians,
          .lacks = lacksOfGaussians,
          .attributes = [](const PointCloud&) { return std::vector<const Attribute*>{}; },
          .hasComments = true,
          .onlyCopied = true};
}

}  // namespace palpate
