// Uncompressed PNGs of any bit depth, byte by byte, which stb cannot write.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace palpate {

inline std::string bigEndianWord(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

inline std::string pngChunk(const std::string& name, const std::string& data) {
  const std::string body = name + data;
  std::uint32_t crc = ~0u;
  for (const char c : body) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
  }
  return bigEndianWord(static_cast<std::uint32_t>(data.size())) + body + bigEndianWord(~crc);
}

/// `colorType`: 0 grey, 2 red, green and blue. `rows`: pixel bytes of the image, without filter bytes.
inline std::string pngBytes(std::uint32_t width, std::uint32_t height, int bits, int colorType,
                            const std::string& rows) {
  const std::size_t pitch = rows.size() / height;
  std::string filtered;
  for (std::uint32_t y = 0; y < height; ++y) filtered += '\0' + rows.substr(y * pitch, pitch);
  std::string zlib("\x78\x01", 2);
  std::uint32_t a = 1, b = 0;
  for (const char c : filtered) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  constexpr std::size_t kBlock = 65535;
  for (std::size_t at = 0; at < filtered.size(); at += kBlock) {
    const std::size_t size = std::min(kBlock, filtered.size() - at);
    zlib += at + size == filtered.size() ? '\1' : '\0';
    for (const std::size_t value : {size, ~size})
      for (const unsigned shift : {0u, 8u}) zlib += static_cast<char>(value >> shift & 0xff);
    zlib += filtered.substr(at, size);
  }
  zlib += bigEndianWord(b << 16 | a);
  std::string head = bigEndianWord(width) + bigEndianWord(height);
  for (const int value : {bits, colorType, 0, 0, 0}) head += static_cast<char>(value);
  return "\x89PNG\r\n\x1a\n" + pngChunk("IHDR", head) + pngChunk("IDAT", zlib) + pngChunk("IEND", "");
}

inline std::string greyPng(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> values) {
  std::string rows;
  for (const std::uint16_t value : values)
    rows += std::string{static_cast<char>(value >> 8), static_cast<char>(value & 0xff)};
  return pngBytes(width, height, 16, 0, rows);
}

inline void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace palpate
