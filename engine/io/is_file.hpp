#pragma once

#include <filesystem>
#include <system_error>

namespace palpate {

/// Whether the path is a regular file; false if that cannot be determined.
inline bool isFile(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

}  // namespace palpate
