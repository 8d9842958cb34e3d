#pragma once

#include <filesystem>
#include <system_error>

namespace palpate {

/// Whether it is there and a file; one that cannot be asked for is not.
inline bool isFile(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

}  // namespace palpate
