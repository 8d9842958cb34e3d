// Integers that are close to an expected value, as LASzip codes them: by the number of bits of their difference, and
// then by these bits, of which the upper ones have a model.
#pragma once

#include <bit>

#include "engine/io/range_coder.hpp"

namespace palpate {

class IntegerModel {
 public:
  /// Integers of 16 or 32 bits, in `contexts` contexts, each with its own model of bit counts.
  IntegerModel(unsigned bits, unsigned contexts)
      : bits_(bits),
        mask_(static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1)),
        lengths_(contexts),
        uppers_(bits + 1) {}

  /// State of an integer while it is coded step by step; an encoder sets all of it in the first step.
  struct Number {
    std::int32_t expected = 0;
    unsigned length = 0;
    std::uint32_t place = 0;  // rank among all numbers of this length
  };

  // The steps of coding an integer, in their order. Steps of other streams may be interleaved.
  template <class Coder>
  [[gnu::always_inline]] void codeLength(Coder& coder, Number& number, std::int32_t expected, std::int32_t value,
                                         unsigned context) {
    number.expected = expected;
    if constexpr (Coder::kEncodes) setPlace(number, difference(value, expected));
    number.length = coder.symbol(made(lengths_[context], bits_ + 1), number.length);
    lastLength_ = number.length;
  }
  template <class Coder>
  [[gnu::always_inline]] void codeUpper(Coder& coder, Number& number) {
    if (number.length - 1 < 31) [[likely]] {
      const unsigned upper = number.length < kUpperBits ? number.length : kUpperBits;
      const std::uint32_t top =
          coder.symbol(made(uppers_[number.length], 1u << upper), number.place >> (number.length - upper));
      if constexpr (!Coder::kEncodes) number.place = top;
    } else if (number.length == 0) {
      number.place = coder.bit(zeroOrOne_, number.place == 0) ? 0 : 0u - 1u;
    } else {
      number.place = kMin;
    }
  }
  /// Returns the integer. 32-bit integers wrap around; the decoder returns 16-bit integers as 0 to 65535.
  template <class Coder>
  [[gnu::always_inline]] std::int32_t codeLower(Coder& coder, Number& number) {
    if (number.length > kUpperBits && number.length < 32) {
      const unsigned lower = number.length - kUpperBits;
      const std::uint32_t rest = coder.bits(lower, number.place & ((1u << lower) - 1));
      if constexpr (!Coder::kEncodes) number.place = number.place << lower | rest;
    }
    // Without a branch, since the sign is unpredictable.
    const std::uint64_t all = std::uint64_t{1} << number.length;
    const std::uint64_t negative = number.place < static_cast<std::uint32_t>(all / 2) ? 1 : 0;
    const std::uint32_t sum = static_cast<std::uint32_t>(number.expected) + number.place + 1 -
                              static_cast<std::uint32_t>(negative << number.length);
    return static_cast<std::int32_t>(sum & mask_);
  }

  /// All steps in sequence.
  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t expected, std::int32_t value, unsigned context) {
    Number number;
    codeLength(coder, number, expected, value, context);
    codeUpper(coder, number);
    return codeLower(coder, number);
  }

  /// Number of bits of the last difference.
  unsigned lastLength() const { return lastLength_; }

 private:
  static constexpr unsigned kUpperBits = 8;
  static constexpr std::uint32_t kMin = 0x7fffffffu;  // rank of the only number of length 32

  std::int32_t difference(std::int32_t value, std::int32_t expected) const {
    const std::uint32_t off = static_cast<std::uint32_t>(value) - static_cast<std::uint32_t>(expected);
    if (bits_ == 32) return static_cast<std::int32_t>(off);
    const std::uint32_t half = 1u << (bits_ - 1), mask = 2 * half - 1;
    return static_cast<std::int32_t>((off + half) & mask) - static_cast<std::int32_t>(half);
  }

  // Length n > 0 has the numbers from 2^(n-1) + 1 to 2^n, and from 1 - 2^n to -2^(n-1): the lower half of 2^n ranks
  // represents the negative ones. Length 0 has 0 (rank -1) and 1; length 32 has only the minimum.
  static void setPlace(Number& number, std::int32_t off) {
    const auto raw = static_cast<std::uint32_t>(off);
    number.length = static_cast<unsigned>(std::bit_width(off <= 0 ? 0 - raw : raw - 1));
    number.place = raw - 1;
    if (off < 0) number.place += static_cast<std::uint32_t>(std::uint64_t{1} << number.length);
  }

  static SymbolModel& made(SymbolModel& model, unsigned symbols) {
    if (!model.isMade()) [[unlikely]]
      make(model, symbols);
    return model;
  }
  [[gnu::noinline]] static void make(SymbolModel& model, unsigned symbols) { model = SymbolModel(symbols); }

  unsigned bits_;
  std::uint32_t mask_;
  std::vector<SymbolModel> lengths_, uppers_;
  BitModel zeroOrOne_;
  unsigned lastLength_ = 0;
};

}  // namespace palpate
