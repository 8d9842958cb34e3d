// The formats that clouds are read from and written to, one line each: nothing else needs to know which there are.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"

namespace palpate {

/// A cloud as a file holds it, with what came along.
struct StoredCloud {
  PointCloud cloud;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of its faces; empty where there are none
  /// What the file has and this does not, in words: "12 edge", "normals in double precision".
  std::vector<std::string> lost;
};

struct CloudReadOptions {
  bool normalsFromFaces = false;  ///< area-weighted, in place of any that the file gives
};
struct CloudWriteOptions {
  bool ascii = false;
  std::filesystem::path* keptAs = nullptr;  ///< as in PlyWriteOptions
};

struct CloudFormat {
  std::string_view name;
  std::string_view ending;  ///< of file names, lower case, with the dot
  /// Throws FileError with the place. Null where it is only written.
  StoredCloud (*read)(const std::filesystem::path& file, Log* log, const CloudReadOptions& options);
  /// The file appears under its name only when it is whole. Throws FileError. Null where it is only read.
  void (*write)(const std::filesystem::path& file, const StoredCloud& stored, const CloudWriteOptions& options);
  /// What of a cloud the format cannot hold, in words.
  std::vector<std::string> (*lacks)(const StoredCloud& stored);
};

std::span<const CloudFormat> cloudFormats();

/// By the file's ending, in any case; what has none that is known is taken for PLY, whose reader says what it found.
const CloudFormat& formatToRead(const std::filesystem::path& file);
/// By the file's ending. Throws UsageError, naming the endings that there are, for another one.
const CloudFormat& formatToWrite(const std::filesystem::path& file);

}  // namespace palpate
