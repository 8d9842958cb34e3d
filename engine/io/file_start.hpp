// The first bytes of a file, by which formats recognise their files independent of names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace palpate {

/// Whether the path is a regular file; false if that cannot be determined.
inline bool isFile(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

/// First bytes of a regular file; text is without its byte order mark, and UTF-16 is converted to UTF-8.
struct FileStart {
  std::string bytes;
  std::uint64_t size = 0;  ///< of the file

  bool startsWith(std::string_view magic) const { return std::string_view(bytes).starts_with(magic); }
  /// Whether all bytes may occur in text.
  bool isText() const;
  /// The first lines that are not blank, without those that begin with '#' or "//"; the last one may be truncated.
  std::vector<std::vector<std::string>> lines(std::size_t most) const;
};

/// Nothing for pipes, folders and missing files. Throws nothing.
std::optional<FileStart> startOf(const std::filesystem::path& file);

/// Whether a word is a number.
bool isNumberWord(std::string_view word);

}  // namespace palpate
