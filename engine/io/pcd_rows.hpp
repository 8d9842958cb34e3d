// Converts the rows of a PCD file to columns of a cloud.
#pragma once

#include <optional>

#include "engine/io/pcd_header.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_vertices.hpp"

namespace palpate {

/// Names are converted to those shared by all formats: normal_x becomes nx, the bytes of rgb become red, green and
/// blue, a field of several numbers NAME_0, NAME_1 and so on. Padding (`_`) is skipped.
class PcdRows {
 public:
  PcdRows(const std::filesystem::path& file, const PcdHeader& header, Log* log);

  void reserve(std::uint64_t points) { vertices_.reserve(points); }
  struct Bad {
    std::size_t row;
    std::string what;
  };
  /// Appends rows in the layout of the file.
  std::optional<Bad> append(const std::byte* rows, std::size_t count);
  PointCloud finish(Log* log) { return vertices_.finish(log); }
  std::vector<std::string> lost() const { return vertices_.lost(); }

  /// Columns after conversion.
  static PlyElement elementOf(const PcdHeader& header);

 private:
  struct Column {
    std::size_t at;
    ScalarType type;
  };
  static std::vector<Column> columnsOf(const PcdHeader& header, PlyElement* element);
  void appendRow(const std::byte* row);

  std::vector<Column> columns_;
  std::size_t rowBytes_;
  PlyVertices vertices_;
  std::vector<std::byte> packed_;
};

}  // namespace palpate
