// From the rows of a PCD file to those of a cloud's attributes.
#pragma once

#include <optional>

#include "engine/io/pcd_header.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_vertices.hpp"

namespace palpate {

/// Names become those that all formats share: normal_x is nx, the bytes of rgb are red, green and blue, a field of many
/// numbers NAME_0, NAME_1 and so on. Padding (`_`) is left out.
class PcdRows {
 public:
  PcdRows(const std::filesystem::path& file, const PcdHeader& header, Log* log);

  void reserve(std::uint64_t points) { vertices_.reserve(points); }
  struct Bad {
    std::size_t row;
    std::string what;
  };
  /// Takes rows as the file has them.
  std::optional<Bad> append(const std::byte* rows, std::size_t count);
  PointCloud finish(Log* log) { return vertices_.finish(log); }
  std::vector<std::string> lost() const { return vertices_.lost(); }

  /// What the rows become.
  static PlyElement elementOf(const PcdHeader& header);

 private:
  enum class From : std::uint8_t { number, wide, wideSigned };  // 64 bits become double precision
  struct Column {
    std::size_t at;
    ScalarType type;
    From from;
  };
  static std::vector<Column> columnsOf(const PcdHeader& header, PlyElement* element);
  void appendRow(const std::byte* row);

  std::vector<Column> columns_;
  std::size_t rowBytes_;
  PlyVertices vertices_;
  std::vector<std::byte> packed_;
};

}  // namespace palpate
