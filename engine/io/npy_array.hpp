// An array as NumPy writes it (format versions 1 to 3): a line that describes it, then its numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/cloud/scalar_type.hpp"

namespace palpate {

/// Numbers of a kind, one of each row.
struct NpyColumn {
  std::string name;
  ScalarType type = ScalarType::f64;  ///< what it is carried as: whole numbers of 64 bits in double precision
  bool wide = false, isSigned = false, swap = false;
  std::uint64_t at = 0;      ///< of the first number, from where the numbers begin
  std::uint64_t stride = 0;  ///< bytes from row to row
};

struct NpyArray {
  bool structured = false;  ///< its columns have names; others are called by their number
  std::vector<std::uint64_t> shape;
  std::uint64_t rows = 0, bytes = 0;
  std::vector<NpyColumn> columns;
  std::span<const std::byte> data;

  std::string shapeText() const;  ///< "(100, 3)"
};

/// `file`: all bytes of one, whose first is byte `at` of what `name` is. Throws FileError with the byte.
NpyArray readNpyArray(const std::filesystem::path& name, std::span<const std::byte> file, std::uint64_t at);

/// A number of a column as it is carried; `to` takes sizeOf(column.type) bytes.
void loadNpy(const NpyColumn& column, std::span<const std::byte> data, std::uint64_t row, std::byte* to);
double npyValue(const NpyColumn& column, std::span<const std::byte> data, std::uint64_t row);

}  // namespace palpate
