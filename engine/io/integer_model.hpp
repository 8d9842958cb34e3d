// Whole numbers that are close to what is expected of them, as LASzip codes them: by how many bits their difference
// has, and then by its bits, of which the upper ones have a model.
#pragma once

#include <bit>

#include "engine/io/range_coder.hpp"

namespace palpate {

class IntegerModel {
 public:
  /// Numbers of 16 or of 32 bits, in so many contexts of which each has its own counts of bits.
  IntegerModel(unsigned bits, unsigned contexts) : bits_(bits), lengths_(contexts), uppers_(bits + 1) {}

  /// Numbers of 32 bits wrap around; those of 16 come out of the decoder as 0 to 65535.
  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t expected, std::int32_t value, unsigned context) {
    std::int32_t off = 0;
    if constexpr (Coder::kEncodes) off = difference(value, expected);
    off = codeDifference(coder, off, context);
    if constexpr (Coder::kEncodes) return value;
    const std::uint32_t sum = static_cast<std::uint32_t>(expected) + static_cast<std::uint32_t>(off);
    return static_cast<std::int32_t>(bits_ < 32 ? sum & ((1u << bits_) - 1) : sum);
  }

  /// How many bits the difference of the last number had.
  unsigned lastLength() const { return lastLength_; }

 private:
  static constexpr unsigned kUpperBits = 8;

  std::int32_t difference(std::int32_t value, std::int32_t expected) const {
    const std::uint32_t off = static_cast<std::uint32_t>(value) - static_cast<std::uint32_t>(expected);
    if (bits_ == 32) return static_cast<std::int32_t>(off);
    const std::uint32_t half = 1u << (bits_ - 1), mask = 2 * half - 1;
    return static_cast<std::int32_t>((off + half) & mask) - static_cast<std::int32_t>(half);
  }

  // Of length n > 0 are those from 2^(n-1) + 1 to 2^n, and from 1 - 2^n to -2^(n-1): the lower half of 2^n numbers
  // stands for the negative ones. Of length 0 are 0 and 1; of length 32 the least one alone.
  template <class Coder>
  std::int32_t codeDifference(Coder& coder, std::int32_t off, unsigned context) {
    unsigned length = 0;
    if constexpr (Coder::kEncodes) {
      const auto raw = static_cast<std::uint32_t>(off);
      length = static_cast<unsigned>(std::bit_width(off <= 0 ? 0 - raw : raw - 1));
    }
    length = coder.symbol(made(lengths_[context], bits_ + 1), length);
    lastLength_ = length;
    if (length == 0) return coder.bit(zeroOrOne_, off != 0) ? 1 : 0;
    if (length == 32) return static_cast<std::int32_t>(0x80000000u);
    const std::uint32_t reach = (1u << length) - 1, half = 1u << (length - 1);
    std::uint32_t place = 0;
    if constexpr (Coder::kEncodes) place = static_cast<std::uint32_t>(off) + (off < 0 ? reach : 0u - 1u);
    const unsigned upper = length < kUpperBits ? length : kUpperBits, lower = length - upper;
    SymbolModel& model = made(uppers_[length], 1u << upper);
    if (lower == 0) {
      place = coder.symbol(model, place);
    } else {
      const std::uint32_t top = coder.symbol(model, place >> lower);
      place = top << lower | coder.bits(lower, place & ((1u << lower) - 1));
    }
    return static_cast<std::int32_t>(place >= half ? place + 1 : place - reach);
  }

  static SymbolModel& made(SymbolModel& model, unsigned symbols) {
    if (!model.isMade()) model = SymbolModel(symbols);
    return model;
  }

  unsigned bits_;
  std::vector<SymbolModel> lengths_, uppers_;
  BitModel zeroOrOne_;
  unsigned lastLength_ = 0;
};

}  // namespace palpate
