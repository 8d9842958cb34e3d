#include "engine/io/crc32c.hpp"

#include <array>
#include <cstring>

namespace palpate {

namespace {

/// Remainders of each byte followed by zero to seven zero bytes, to process eight bytes at a time (Kounavis and Berry
/// 2008, "Novel table lookup-based algorithms for high-performance CRC generation").
struct Tables {
  std::array<std::array<std::uint32_t, 256>, 8> of{};

  constexpr Tables() {
    constexpr std::uint32_t kPolynomial = 0x82f63b78u;  // lowest bit first
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      std::uint32_t rest = byte;
      for (int bit = 0; bit < 8; ++bit) rest = rest >> 1 ^ (rest & 1 ? kPolynomial : 0);
      of[0][byte] = rest;
    }
    for (std::size_t zeros = 1; zeros < 8; ++zeros)
      for (std::size_t byte = 0; byte < 256; ++byte)
        of[zeros][byte] = of[zeros - 1][byte] >> 8 ^ of[0][of[zeros - 1][byte] & 255];
  }
};
constexpr Tables kTables;

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes) {
  std::uint32_t rest = 0xffffffffu;
  std::size_t at = 0;
  for (; at + 8 <= bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    word ^= rest;
    rest = 0;
    for (std::size_t k = 0; k < 8; ++k) rest ^= kTables.of[7 - k][word >> (8 * k) & 255];
  }
  for (; at < bytes.size(); ++at)
    rest = rest >> 8 ^ kTables.of[0][(rest ^ static_cast<std::uint32_t>(bytes[at])) & 255];
  return ~rest;
}

}  // namespace palpate
