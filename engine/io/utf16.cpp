#include "engine/io/utf16.hpp"

namespace palpate {

std::optional<Utf16Start> utf16Start(std::span<const std::byte> begin) {
  if (begin.size() < 2) return std::nullopt;
  const auto byte = [&](std::size_t k) { return std::to_integer<unsigned>(begin[k]); };
  if (byte(0) == 0xff && byte(1) == 0xfe) return Utf16Start{.bigEndian = false, .markBytes = 2};
  if (byte(0) == 0xfe && byte(1) == 0xff) return Utf16Start{.bigEndian = true, .markBytes = 2};
  if (begin.size() < 4) return std::nullopt;
  const auto isLetter = [&](std::size_t k) { return byte(k) == '\t' || (byte(k) >= ' ' && byte(k) <= '~'); };
  if (isLetter(0) && byte(1) == 0 && isLetter(2) && byte(3) == 0) return Utf16Start{.bigEndian = false};
  if (byte(0) == 0 && isLetter(1) && byte(2) == 0 && isLetter(3)) return Utf16Start{.bigEndian = true};
  return std::nullopt;
}

void Utf16Decoder::decode(std::span<const std::byte> bytes, BareVector<std::byte>& out) {
  for (const std::byte raw : bytes) {
    const auto byte = std::to_integer<unsigned>(raw);
    if (!half_) {
      half_ = byte;
      continue;
    }
    const std::uint32_t unit = bigEndian_ ? *half_ << 8 | byte : byte << 8 | *half_;
    half_.reset();
    const bool isHigh = (unit & 0xfc00) == 0xd800, isLow = (unit & 0xfc00) == 0xdc00;
    if (high_ != 0 && isLow) {
      put(0x10000 + ((high_ & 0x3ff) << 10) + (unit & 0x3ff), out);
      high_ = 0;
      continue;
    }
    if (high_ != 0) put('?', out);
    high_ = isHigh ? unit : 0;
    if (!isHigh) put(isLow ? '?' : unit, out);
  }
}

void Utf16Decoder::put(std::uint32_t code, BareVector<std::byte>& out) {
  const auto add = [&](std::uint32_t byte) { out.push_back(static_cast<std::byte>(byte)); };
  const auto further = [&](unsigned shift) { add(0x80 | ((code >> shift) & 0x3f)); };
  if (code < 0x80) return add(code);
  if (code < 0x800) return add(0xc0 | code >> 6), further(0);
  if (code < 0x10000) return add(0xe0 | code >> 12), further(6), further(0);
  add(0xf0 | code >> 18), further(12), further(6), further(0);
}

}  // namespace palpate
