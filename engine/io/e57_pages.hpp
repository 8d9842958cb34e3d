// The bytes of an E57 file (ASTM E2807), which stand in pages with a checksum each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "engine/core/bare_vector.hpp"
#include "engine/core/log.hpp"

namespace palpate {

class E57Pages {
 public:
  /// Reads all of the file, and every checksum. Throws FileError with the byte and the page of what is damaged.
  E57Pages(const std::filesystem::path& file, Log* log);

  const std::filesystem::path& file() const { return file_; }
  std::string_view xml() const { return xml_; }

  /// Bytes without the checksums among them, from a byte of the file on. Throws FileError where there are not so many;
  /// `saidAt` is the byte of the file that says so.
  std::span<const std::byte> from(std::uint64_t fileByte, std::uint64_t count, std::uint64_t saidAt) const;
  /// All that follow a byte of the file.
  std::span<const std::byte> from(std::uint64_t fileByte, std::uint64_t saidAt) const;
  /// The byte of the file that one of those bytes is.
  std::uint64_t fileByteOf(const std::byte* at) const;

 private:
  void checkPages(std::span<const std::byte> whole);
  void readHeader(std::size_t fileBytes);

  std::filesystem::path file_;
  BareVector<std::byte> bytes_;
  std::string_view xml_;
};

}  // namespace palpate
