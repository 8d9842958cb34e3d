// An array as written by NumPy (format versions 1 to 3): a header line that describes it, then its numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/cloud/scalar_type.hpp"

namespace palpate {

/// Numbers of one type, one per row.
struct NpyColumn {
  std::string name;
  ScalarType type = ScalarType::f64;  ///< type after conversion: 64-bit integers become double precision
  bool swap = false;
  std::uint64_t at = 0;      ///< offset of the first number in the data
  std::uint64_t stride = 0;  ///< bytes from row to row
};

struct NpyArray {
  bool structured = false;  ///< columns have names; otherwise they are named by their index
  std::vector<std::uint64_t> shape;
  std::uint64_t rows = 0, bytes = 0;
  std::vector<NpyColumn> columns;
  std::span<const std::byte> data;

  std::string shapeText() const;  ///< "(100, 3)"
};

/// `file`: all bytes of an array file, which begins at byte `at` of `name`. Throws FileError with the byte.
NpyArray readNpyArray(const std::filesystem::path& name, std::span<const std::byte> file, std::uint64_t at);

/// Loads a number of a column after conversion; `to` receives sizeOf(column.type) bytes.
void loadNpy(const NpyColumn& column, std::span<const std::byte> data, std::uint64_t row, std::byte* to);
double npyValue(const NpyColumn& column, std::span<const std::byte> data, std::uint64_t row);

}  // namespace palpate
