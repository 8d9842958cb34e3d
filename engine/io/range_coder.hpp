// The arithmetic coder of LASzip: symbols are parts of an interval, proportional to their frequency; the interval is
// narrowed until a byte of it is known. Frequencies are adapted on both sides during coding (Said 2004, "Introduction
// to arithmetic coding: theory and practice"; Isenburg 2013, "LASzip: lossless compression of LiDAR data").
//
// Decoder and encoder have the same functions: those of the encoder write a value to the stream and return it, those of
// the decoder ignore the value and return that of the stream. So one piece of code serves both directions
// (laz_point10.hpp and the others).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace palpate {

/// Probability that a bit is 0, estimated from previous bits.
class BitModel {
 public:
  static constexpr unsigned kShift = 13;  ///< the share of zeros is in units of 2^-13

  std::uint32_t zeroShare() const { return zeroShare_; }
  void count(bool isZero) {
    zeros_ += isZero;
    if (--untilUpdate_ == 0) update();
  }

 private:
  [[gnu::noinline, gnu::cold]] void update();

  std::uint32_t zeroShare_ = 1u << (kShift - 1), zeros_ = 1, all_ = 2;
  std::uint32_t cycle_ = 4, untilUpdate_ = 4;
};

/// Probabilities of several symbols, estimated from previous symbols.
class SymbolModel {
 public:
  static constexpr unsigned kShift = 15;  ///< shares are in units of 2^-15

  SymbolModel() = default;
  explicit SymbolModel(unsigned symbols);

  bool isMade() const { return !words_.empty(); }
  unsigned last() const { return last_; }
  /// Sum of the shares of all symbols before this one.
  std::uint32_t before(unsigned symbol) const { return words_[sharesAt_ + symbol]; }
  /// The cumulative shares at which a search for the symbol containing `share` starts. It ends within kBehind more
  /// entries, which exceed all shares.
  const std::uint16_t* from(std::uint32_t share) const { return words_.data() + words_[share >> cellShift_]; }
  unsigned symbolOf(const std::uint16_t* shares) const {
    return static_cast<unsigned>(shares - words_.data()) - sharesAt_;
  }
  void count(unsigned symbol) {
    ++words_[countsAt_ + symbol];
    if (--untilUpdate_ == 0) [[unlikely]]
      update();
  }

 private:
  static constexpr unsigned kBehind = 6;
  [[gnu::noinline, gnu::cold]] void update();

  // For each of equal cells, the index of the cumulative share where a search starts; the cumulative shares before each
  // symbol, followed by kBehind entries that exceed all shares; and the count of each symbol. One block of memory, of
  // which little is touched.
  std::vector<std::uint16_t> words_;
  std::uint16_t last_ = 0, sharesAt_ = 0, countsAt_ = 0, cellShift_ = 0;
  std::uint32_t all_ = 0, cycle_ = 0, untilUpdate_ = 0;
};

/// Common to decoder and encoder.
class RangeCoder {
 protected:
  static constexpr std::uint32_t kShortest = 1u << 24;  // minimum length of the interval; else extended by a byte
  static constexpr unsigned kMaxBits = 19;              // coded at a time without a model
};

/// Reads zeros beyond the end of its bytes, and records this as an error. `mayEnd` = false: the caller guarantees that
/// left() is large enough, kMaxBytes for each call; the result is the same, but faster.
template <bool mayEnd>
class RangeDecoderOf : RangeCoder {
 public:
  static constexpr bool kEncodes = false;
  static constexpr std::size_t kMaxBytes = 6;  ///< maximum per call, with look-ahead; slightly more for the last one

  explicit RangeDecoderOf(std::span<const std::byte> bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {
    for (int k = 0; k < 4; ++k) value_ = value_ << 8 | next();
    // The following code requires the value to be within the interval, as encoders guarantee.
    if (value_ >= length_) wrong_ = true, value_ = 0;
  }
  /// Continues at the position of another decoder.
  explicit RangeDecoderOf(const RangeDecoderOf<!mayEnd>& other)
      : at_(other.at_), end_(other.end_), value_(other.value_), length_(other.length_), wrong_(other.wrong_) {}

  /// The stream is invalid, or was read with other models: it ended too early, or contained an invalid symbol.
  bool isWrong() const { return wrong_; }
  /// Number of unused bytes: 0 after a stream was read completely.
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  void setWrong() { wrong_ = true; }

  [[gnu::always_inline]] unsigned symbol(SymbolModel& model, unsigned = 0) {
    // The latency of this search limits the speed of decoding: it has few steps, and no branch unless a cell of the
    // table has more than three symbols, which are then rare ones.
    const std::uint32_t whole = length_ >> SymbolModel::kShift;
    const std::uint64_t part = whole, value = value_;
    const std::uint16_t* at = model.from(value_ / whole);
    std::uint64_t low = at[0] * part, first = at[1] * part, second = at[2] * part, third = at[3] * part;
    while (value >= third) [[unlikely]] {
        at += 3;
        low = third, first = at[1] * part, second = at[2] * part, third = at[3] * part;
      }
    const bool one = value >= first, two = value >= second;
    low = one ? first : low;
    std::uint64_t high = one ? second : first;
    low = two ? second : low;
    high = two ? third : high;
    // The entry behind the last symbol exceeds all shares, and its part extends to the end of the length.
    high = high < length_ ? high : length_;
    const unsigned found = model.symbolOf(at) + (one ? 1u : 0u) + (two ? 1u : 0u);
    value_ = static_cast<std::uint32_t>(value - low);
    length_ = static_cast<std::uint32_t>(high - low);
    widen();
    model.count(found);
    return found;
  }
  [[gnu::always_inline]] bool bit(BitModel& model, bool = false) {
    const std::uint32_t zeros = model.zeroShare() * (length_ >> BitModel::kShift);
    const bool found = value_ >= zeros;
    length_ = found ? length_ - zeros : zeros;
    value_ -= found ? zeros : 0;
    widen();
    model.count(!found);
    return found;
  }
  /// `count`: maximum 32.
  [[gnu::always_inline]] std::uint32_t bits(unsigned count, std::uint32_t = 0) {
    if (count <= kMaxBits) return fewBits(count);
    const std::uint32_t low = fewBits(16);
    return fewBits(count - 16) << 16 | low;
  }

 private:
  [[gnu::always_inline]] std::uint32_t fewBits(unsigned count) {
    length_ >>= count;
    std::uint32_t found = value_ / length_;
    value_ -= found * length_;
    if (found >> count) [[unlikely]]
      wrong_ = true, found = 0;
    widen();
    return found;
  }
  std::uint32_t next() {
    if (at_ < end_) return static_cast<std::uint32_t>(*at_++);
    wrong_ = true;
    return 0;
  }
  /// Without a branch except near the end, since the number of bytes is unpredictable.
  [[gnu::always_inline]] void widen() {
    const auto bits = static_cast<unsigned>(std::countl_zero(length_ | 1)) & 24u;  // the length is never 0
    if (mayEnd && end_ - at_ < 4) [[unlikely]] {
      for (unsigned k = 0; k < bits; k += 8) value_ = value_ << 8 | next();
    } else {
      const auto byte = [&](unsigned k) { return static_cast<std::uint32_t>(at_[k]); };
      const std::uint32_t ahead = byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);  // one load
      value_ = static_cast<std::uint32_t>((std::uint64_t{value_} << 32 | ahead) << bits >> 32);
      at_ += bits / 8;
    }
    length_ <<= bits;
  }

  friend class RangeDecoderOf<!mayEnd>;
  const std::byte *at_, *end_;
  std::uint32_t value_ = 0, length_ = 0xffffffffu;
  bool wrong_ = false;
};
using RangeDecoder = RangeDecoderOf<true>;

class RangeEncoder : RangeCoder {
 public:
  static constexpr bool kEncodes = true;

  void setWrong() {}  ///< encoded data is always valid

  unsigned symbol(SymbolModel& model, unsigned value) {
    const std::uint32_t part = length_ >> SymbolModel::kShift, low = model.before(value) * part;
    const std::uint32_t high = value == model.last() ? length_ : model.before(value + 1) * part;
    narrow(low, high - low);
    model.count(value);
    return value;
  }
  bool bit(BitModel& model, bool value) {
    const std::uint32_t zeros = model.zeroShare() * (length_ >> BitModel::kShift);
    narrow(value ? zeros : 0, value ? length_ - zeros : zeros);
    model.count(!value);
    return value;
  }
  std::uint32_t bits(unsigned count, std::uint32_t value) {
    if (count > kMaxBits) {
      bits(16, value & 0xffffu);
      bits(count - 16, value >> 16);
      return value;
    }
    const std::uint32_t part = length_ >> count;
    narrow(value * part, part);
    return value;
  }

  /// Returns the stream, of which the decoder needs every byte; call once, at the end.
  std::vector<std::byte> finish();

 private:
  void narrow(std::uint32_t from, std::uint32_t length) {
    base_ += from;
    if (base_ < from) carry();
    length_ = length;
    while (length_ < kShortest) {
      bytes_.push_back(static_cast<std::byte>(base_ >> 24));
      base_ <<= 8;
      length_ <<= 8;
    }
  }
  void carry();

  std::vector<std::byte> bytes_;
  std::uint32_t base_ = 0, length_ = 0xffffffffu;
};

}  // namespace palpate
