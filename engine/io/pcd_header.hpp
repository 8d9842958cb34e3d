// The header of PCD files (Point Cloud Library; Rusu and Cousins 2011), versions 0.5 to 0.7.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/scalar_type.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_vertices.hpp"

namespace palpate {

enum class PcdData : std::uint8_t { ascii, binary, compressed };

struct PcdField {
  std::string name;
  std::size_t bytes = 4;  ///< of one number
  char type = 'F';        ///< I, U or F
  std::size_t count = 1;  ///< numbers per point
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0, width = 0, height = 1;
  std::string viewpoint;
  PcdData data = PcdData::ascii;
  std::vector<std::string> comments;  ///< as in StoredAs
  std::uint64_t line = 0;             ///< number of its last line

  std::size_t rowBytes() const;
};

/// Reads up to the first byte of the points. Throws FileError with the line of the error.
PcdHeader readPcdHeader(ChunkedFile& file);

/// Calls f(std::type_identity<T>{}) with the type of a field's numbers, which readPcdHeader() has validated.
template <class F>
decltype(auto) visitPcd(const PcdField& field, F&& f) {
  const auto whole = [&]<class I8, class I16, class I32, class I64>(I8 one, I16 two, I32 four, I64 eight) {
    switch (field.bytes) {
      case 1:
        return f(std::type_identity<decltype(one)>{});
      case 2:
        return f(std::type_identity<decltype(two)>{});
      case 4:
        return f(std::type_identity<decltype(four)>{});
      default:
        return f(std::type_identity<decltype(eight)>{});
    }
  };
  if (field.type == 'I') return whole(std::int8_t{}, std::int16_t{}, std::int32_t{}, std::int64_t{});
  if (field.type == 'U') return whole(std::uint8_t{}, std::uint16_t{}, std::uint32_t{}, std::uint64_t{});
  return field.bytes == 8 ? f(std::type_identity<double>{}) : f(std::type_identity<float>{});
}

/// Converts the rows of a PCD file to columns of a cloud.
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
