// UTF-16 text, as saved by Windows programs as "Unicode" (The Unicode Standard, chapter 3.9).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/core/bare_vector.hpp"

namespace palpate {

/// Detects UTF-16 by its byte order mark, or by a one-byte character and a zero byte.
struct Utf16Start {
  bool bigEndian = false;
  std::size_t markBytes = 0;
};
std::optional<Utf16Start> utf16Start(std::span<const std::byte> begin);

/// Converts bytes to UTF-8 incrementally. Unpaired surrogates become '?'.
class Utf16Decoder {
 public:
  explicit Utf16Decoder(bool bigEndian) : bigEndian_(bigEndian) {}

  /// Appends to `out`.
  void decode(std::span<const std::byte> bytes, BareVector<std::byte>& out);

 private:
  void put(std::uint32_t code, BareVector<std::byte>& out);

  bool bigEndian_;
  std::optional<unsigned> half_;  // the first byte of a unit
  std::uint32_t high_ = 0;        // the first unit of a surrogate pair
};

}  // namespace palpate
