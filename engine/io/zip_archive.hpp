// The members of a ZIP archive (PKWARE's APPNOTE 6.3, with its sizes of 64 bits), stored or deflated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpate {

struct ZipMember {
  std::string name;
  std::uint64_t at = 0;  ///< of its first byte as packed
  std::uint64_t packed = 0, bytes = 0;
  std::uint32_t checksum = 0;
  bool deflated = false;
};

/// CRC-32 as archives have it.
std::uint32_t zipChecksum(std::span<const std::byte> bytes);

/// `archive`: all its bytes. Throws FileError with the byte.
std::vector<ZipMember> zipMembers(const std::filesystem::path& file, std::span<const std::byte> archive);

/// A member as it was before it was packed. Throws FileError where it is damaged.
std::vector<std::byte> unpackZip(const std::filesystem::path& file, std::span<const std::byte> archive,
                                 const ZipMember& member);

/// What gzip packed (RFC 1952), of one member. Throws FileError where it is damaged, or does not begin as gzip does.
std::vector<std::byte> unpackGzip(const std::filesystem::path& file, std::span<const std::byte> packed);

}  // namespace palpate
