// The bytes of an E57 file (ASTM E2807), stored in pages with a checksum each.
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
  /// Reads the whole file and verifies every checksum. Throws FileError with the byte and the page of the damage.
  E57Pages(const std::filesystem::path& file, Log* log);

  const std::filesystem::path& file() const { return file_; }
  std::string_view xml() const { return xml_; }

  /// `count` bytes from a byte of the file on, without checksums. Throws FileError if the file is too short; `saidAt`
  /// is the byte of the file that contains the request.
  std::span<const std::byte> from(std::uint64_t fileByte, std::uint64_t count, std::uint64_t saidAt) const;
  /// All bytes from a byte of the file on.
  std::span<const std::byte> from(std::uint64_t fileByte, std::uint64_t saidAt) const;
  /// Position in the file of one of those bytes.
  std::uint64_t fileByteOf(const std::byte* at) const;

 private:
  void checkPages(std::span<const std::byte> whole);
  void readHeader(std::size_t fileBytes);

  std::filesystem::path file_;
  BareVector<std::byte> bytes_;
  std::string_view xml_;
};

}  // namespace palpate
