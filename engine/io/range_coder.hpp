// The arithmetic coder of LASzip: symbols become parts of an interval, as wide as they are frequent, which is halved
// until a byte of it is known; how frequent they are is counted on both sides while they pass (Said 2004, "Introduction
// to arithmetic coding: theory and practice"; Isenburg 2013, "LASzip: lossless compression of LiDAR data").
//
// Decoder and encoder have the same functions: those of the encoder put a value into the stream and give it back, those
// of the decoder give the one of the stream, whatever they are given. So what is coded, and in what order, is one text
// for both (laz_point10.hpp and the others).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace palpate {

/// How likely a bit is 0, by those that passed.
class BitModel {
 public:
  static constexpr unsigned kShift = 13;  ///< the share of zeros is in parts of 2^13

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

/// How likely each of several symbols is, by those that passed.
class SymbolModel {
 public:
  static constexpr unsigned kShift = 15;  ///< shares are in parts of 2^15

  SymbolModel() = default;
  explicit SymbolModel(unsigned symbols);

  bool isMade() const { return !words_.empty(); }
  unsigned last() const { return last_; }
  /// The share of all symbols before this one.
  std::uint32_t before(unsigned symbol) const { return words_[sharesAt_ + symbol]; }
  /// The shares before a symbol and those behind it: a search for the one that has `share` in its part begins there. It
  /// ends before kBehind more, which nothing reaches.
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

  // Where the shares of the symbol stand at the beginning of each of equal parts, where a search begins; the shares
  // before the symbols, and behind them kBehind that are more than any; how often each symbol passed. In one piece, of
  // which little is touched.
  std::vector<std::uint16_t> words_;
  std::uint16_t last_ = 0, sharesAt_ = 0, countsAt_ = 0, cellShift_ = 0;
  std::uint32_t all_ = 0, cycle_ = 0, untilUpdate_ = 0;
};

/// What decoder and encoder have in common.
class RangeCoder {
 protected:
  static constexpr std::uint32_t kShortest = 1u << 24;  // of the interval: shorter ones get a byte more
  static constexpr unsigned kMaxBits = 19;              // that are coded at a time without a model
};

/// Reads beyond its bytes as if zeros followed, and says so. `mayEnd`: false where whoever decodes has seen to it that
/// so many bytes are left() as can be needed, kMaxBytes for each call; what is decoded is the same, sooner.
template <bool mayEnd>
class RangeDecoderOf : RangeCoder {
 public:
  static constexpr bool kEncodes = false;
  static constexpr std::size_t kMaxBytes = 6;  ///< that a call takes in, and looks ahead; a little more at the last one

  explicit RangeDecoderOf(std::span<const std::byte> bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {
    for (int k = 0; k < 4; ++k) value_ = value_ << 8 | next();
    // What follows takes for granted that the value is within the interval, and no encoder leaves it.
    if (value_ >= length_) wrong_ = true, value_ = 0;
  }
  /// Goes on where another one stands.
  explicit RangeDecoderOf(const RangeDecoderOf<!mayEnd>& other)
      : at_(other.at_), end_(other.end_), value_(other.value_), length_(other.length_), wrong_(other.wrong_) {}

  /// What was read is no stream of an encoder, or was read with other models: it ended too early, or named what there
  /// is not.
  bool isWrong() const { return wrong_; }
  /// Bytes that were not needed: none where a stream was read to its end.
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  void setWrong() { wrong_ = true; }

  [[gnu::always_inline]] unsigned symbol(SymbolModel& model, unsigned = 0) {
    // What comes next waits for this: the steps of the search are few, and have no branch but where a part of the table
    // has more than three symbols, which are rare ones then.
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
    // Behind the last symbol stands a share that is more than all, and its part reaches to the end of the length.
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
  /// `count`: at most 32.
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
  /// Without a branch, but near the end: how many bytes come in next nobody could foresee.
  [[gnu::always_inline]] void widen() {
    const auto bits = static_cast<unsigned>(std::countl_zero(length_ | 1)) & 24u;  // no length is 0
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

  void setWrong() {}  ///< what is encoded is right

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

  /// The stream, of which the decoder needs every byte. Once, at the end.
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
