// The header of a PLY file (Turk 1994, "The PLY Polygon File Format"): what elements follow, in which order and types.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/scalar_type.hpp"
#include "engine/io/chunked_file.hpp"

namespace palpate {

enum class PlyFormat : std::uint8_t { ascii, binaryLittleEndian, binaryBigEndian };
std::string_view plyName(PlyFormat format);

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::f32;
  bool isList = false;
  ScalarType countType = ScalarType::u8;  ///< of a list's length; always an integer type
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  ///< as declared by the header, possibly wrong
  std::vector<PlyProperty> properties;
  std::uint64_t line = 0;  ///< line of its declaration, 1-based

  bool hasLists() const;
  /// Bytes of a row's scalars, packed in the order of the header.
  std::size_t scalarBytes() const;
};

struct PlyInfo {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;   ///< in the order of the file
  std::vector<std::string> comments;  ///< lines that begin with `comment` or `obj_info`, including that word

  /// Null if there is no element of that name.
  const PlyElement* find(std::string_view element) const;
};

/// Reads the header only. Throws FileError with the line of the first error.
PlyInfo readPlyInfo(const std::filesystem::path& file);

/// The same from an open file, which is then at the first byte of the body.
PlyInfo readPlyHeader(ChunkedFile& file);

}  // namespace palpate
