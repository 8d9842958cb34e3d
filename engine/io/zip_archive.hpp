// Reads the members of a ZIP archive (PKWARE's APPNOTE 6.3, with 64-bit sizes), stored or deflated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpate {

struct ZipMember {
  std::string name;
  std::uint64_t at = 0;  ///< offset of its first compressed byte
  std::uint64_t packed = 0, bytes = 0;
  std::uint32_t checksum = 0;
  bool deflated = false;
};

/// CRC-32 as used in archives and in PNG.
std::uint32_t zipChecksum(std::span<const std::byte> bytes);

/// `archive`: all its bytes. Throws FileError with the byte.
std::vector<ZipMember> zipMembers(const std::filesystem::path& file, std::span<const std::byte> archive);

/// Decompresses a member. Throws FileError if it is damaged.
std::vector<std::byte> unpackZip(const std::filesystem::path& file, std::span<const std::byte> archive,
                                 const ZipMember& member);

/// Decompresses gzip data (RFC 1952) of one member. Throws FileError if it is damaged or not gzip.
std::vector<std::byte> unpackGzip(const std::filesystem::path& file, std::span<const std::byte> packed);

}  // namespace palpate
