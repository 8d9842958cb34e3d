// The first bytes of a file, by which formats know their own whatever the file is called.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Of a regular file; text without its mark, and UTF-8 where it is UTF-16.
struct FileStart {
  std::string bytes;
  std::uint64_t size = 0;  ///< of the file

  bool startsWith(std::string_view magic) const { return std::string_view(bytes).starts_with(magic); }
  /// Whether no byte is one that text does not have.
  bool isText() const;
  /// The first lines that have words, less those that begin with '#' or "//"; the last one may be cut.
  std::vector<std::vector<std::string>> lines(std::size_t most) const;
};

/// Nothing of what cannot be looked into: a pipe, a folder, what is not there. Throws nothing.
std::optional<FileStart> startOf(const std::filesystem::path& file);

/// Whether a word is a number.
bool isNumberWord(std::string_view word);

}  // namespace palpate
