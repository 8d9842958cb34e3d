// Text of 16 bits a letter, as Windows' programs save "Unicode" (The Unicode Standard, chapter 3.9).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/core/bare_vector.hpp"

namespace palpate {

/// How text begins that is in UTF-16: with its mark, or with a letter of one byte and a zero.
struct Utf16Start {
  bool bigEndian = false;
  std::size_t markBytes = 0;
};
std::optional<Utf16Start> utf16Start(std::span<const std::byte> begin);

/// Takes bytes as they come, and gives them as UTF-8. Halves of a pair without the other one become '?'.
class Utf16Decoder {
 public:
  explicit Utf16Decoder(bool bigEndian) : bigEndian_(bigEndian) {}

  /// Appends to `out`.
  void decode(std::span<const std::byte> bytes, BareVector<std::byte>& out);

 private:
  void put(std::uint32_t code, BareVector<std::byte>& out);

  bool bigEndian_;
  std::optional<unsigned> half_;  // the first byte of a unit
  std::uint32_t high_ = 0;        // the first unit of a pair
};

}  // namespace palpate
