// What the points of LAZ consist of besides places: times, colours, infrared and bytes, coded by what the point before
// had (Isenburg 2013). Each has one function for both directions (range_coder.hpp): an encoder is given the values, a
// decoder puts them there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/io/integer_model.hpp"

namespace palpate {

/// Whole numbers of 32 bits that wrap around, as those of a damaged file may.
inline std::int32_t wrappedSum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}
inline std::int32_t wrappedDifference(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}
inline std::int32_t wrappedProduct(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(b));
}

/// Models of 256 symbols, made when they are needed first.
template <std::size_t count>
class ByteModels {
 public:
  SymbolModel& operator[](std::size_t k) {
    if (!models_[k].isMade()) models_[k] = SymbolModel(symbols_);
    return models_[k];
  }
  explicit ByteModels(unsigned symbols = 256) : symbols_(symbols) {}

 private:
  std::array<SymbolModel, count> models_;
  unsigned symbols_;
};

/// The middle one of about the last five numbers: of those that came last it forgets the least and the largest in turn.
class StreamingMedian {
 public:
  std::int32_t get() const { return sorted_[2]; }
  /// Into four that stay, without a branch: which place is its own nobody could foresee.
  void add(std::int32_t v) {
    const std::int32_t* const four = sorted_.data() + (forgetsLargest_ ? 0 : 1);
    const std::int32_t a = four[0], b = four[1], c = four[2], d = four[3];
    forgetsLargest_ = forgetsLargest_ ? v < sorted_[2] : v <= sorted_[2];
    sorted_ = {std::min(a, v), std::max(a, std::min(b, v)), std::max(b, std::min(c, v)), std::max(c, std::min(d, v)),
               std::max(d, v)};
  }

 private:
  std::array<std::int32_t, 5> sorted_{};
  bool forgetsLargest_ = true;
};

/// Times, by their bits as whole numbers: those of a scanner grow by the same step again and again, or by multiples of
/// it; several scanners' times, up to four, may alternate.
class LazTimes {
 public:
  /// `mayStay`: a time that is the one before has a symbol of its own, as in version 2; version 3 says it elsewhere.
  LazTimes(std::int64_t first, bool mayStay)
      : stays_(mayStay ? 1 : 0), plain_(5u + stays_), multiple_(kOwn + 4u + stays_) {
    sequences_[0].time = first;
  }

  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t time) {
    for (int turns = 0; turns < 2; ++turns) {  // an encoder changes to another sequence once at most
      Sequence& now = sequences_[current_];
      const bool fresh = now.step == 0;
      // Symbols less than `own` are differences to the sequence's last time; then they are: the same, of a sequence
      // that begins, of another one.
      const unsigned own = fresh ? 0 : kOwn;
      unsigned symbol = 0;
      if constexpr (Coder::kEncodes) symbol = symbolFor(time, own);
      symbol = coder.symbol(fresh ? plain_ : multiple_, symbol);
      if (stays_ && symbol == own) return now.time;
      if (fresh && symbol == stays_) {
        now.step = difference_.code(coder, 0, static_cast<std::int32_t>(time - now.time), 0);
        now.extremes = 0;
        return advance(now, now.step);
      }
      if (symbol < own)
        return advance(now, codeStep(coder, now, symbol, static_cast<std::int32_t>(bitsOff(time, now))));
      const unsigned other = symbol - own - stays_ - (fresh ? 1 : 0);
      if (other == 0) return begin(coder, time);
      current_ = (current_ + other) & 3;
    }
    coder.setWrong();
    return sequences_[current_].time;
  }

 private:
  static constexpr unsigned kMostTimes = 500, kMostBack = 10, kOwn = kMostTimes + kMostBack + 1;
  static constexpr int kMostExtremes = 3;  // steps that fit no multiple: then the step is a new one

  struct Sequence {
    std::int64_t time = 0;
    std::int32_t step = 0;
    int extremes = 0;
  };

  static std::int64_t bitsOff(std::int64_t time, const Sequence& from) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(time) - static_cast<std::uint64_t>(from.time));
  }
  static bool isNear(std::int64_t time, const Sequence& from) {
    const std::int64_t off = bitsOff(time, from);
    return off == static_cast<std::int32_t>(off);
  }
  static std::int64_t advance(Sequence& sequence, std::int32_t step) {
    const std::uint64_t time =
        static_cast<std::uint64_t>(sequence.time) + static_cast<std::uint64_t>(std::int64_t{step});
    return sequence.time = static_cast<std::int64_t>(time);
  }

  unsigned symbolFor(std::int64_t time, unsigned own) const {
    const Sequence& now = sequences_[current_];
    const bool fresh = own == 0;
    if (stays_ && time == now.time) return own;
    if (isNear(time, now)) return fresh ? stays_ : multipleFor(bitsOff(time, now), now.step);
    const unsigned begins = own + stays_ + (fresh ? 1 : 0);
    for (unsigned other = 1; other < 4; ++other)
      if (isNear(time, sequences_[(current_ + other) & 3])) return begins + other;
    return begins;
  }
  static unsigned multipleFor(std::int64_t off, std::int32_t step) {
    const double times = std::round(static_cast<double>(off) / step);
    if (times >= 0) return static_cast<unsigned>(std::min(times, double{kMostTimes}));
    return kMostTimes + static_cast<unsigned>(std::min(-times, double{kMostBack}));
  }

  /// What follows the symbol of a multiple of the step; contexts tell how large it is.
  template <class Coder>
  std::int32_t codeStep(Coder& coder, Sequence& now, unsigned symbol, std::int32_t off) {
    const bool back = symbol > kMostTimes;
    const std::int32_t times = back ? static_cast<std::int32_t>(kMostTimes) - static_cast<std::int32_t>(symbol)
                                    : static_cast<std::int32_t>(symbol);
    const bool extreme = symbol == 0 || symbol == kMostTimes || symbol == kMostTimes + kMostBack;
    const unsigned context = symbol == 0            ? 7u
                             : symbol == 1          ? 1u
                             : symbol < 10          ? 2u
                             : symbol < kMostTimes  ? 3u
                             : symbol == kMostTimes ? 4u
                             : extreme              ? 6u
                                                    : 5u;
    off = difference_.code(coder, wrappedProduct(times, now.step), off, context);
    if (symbol == 1) now.extremes = 0;
    if (extreme && ++now.extremes > kMostExtremes) {
      now.step = off;
      now.extremes = 0;
    }
    return off;
  }

  template <class Coder>
  std::int64_t begin(Coder& coder, std::int64_t time) {
    const auto upper = [](std::int64_t t) { return static_cast<std::int32_t>(static_cast<std::uint64_t>(t) >> 32); };
    const std::int32_t high = difference_.code(coder, upper(sequences_[current_].time), upper(time), 8);
    const std::uint32_t low = coder.bits(32, static_cast<std::uint32_t>(time));
    newest_ = (newest_ + 1) & 3;
    current_ = newest_;
    const std::uint64_t whole = std::uint64_t{static_cast<std::uint32_t>(high)} << 32 | low;
    sequences_[current_] = {static_cast<std::int64_t>(whole), 0, 0};
    return sequences_[current_].time;
  }

  unsigned stays_;  // 1 where mayStay, else 0
  SymbolModel plain_, multiple_;
  IntegerModel difference_{32, 9};
  std::array<Sequence, 4> sequences_{};
  unsigned current_ = 0, newest_ = 0;
};

/// Colours of 16 bits a channel, by their bytes: green by how red has changed, blue by both. Grey says so.
class LazColors {
 public:
  using Color = std::array<std::uint16_t, 3>;

  /// `last` becomes the colour.
  template <class Coder>
  void code(Coder& coder, Color& last, const Color& next) {
    unsigned changes = 0;
    if constexpr (Coder::kEncodes) changes = changesBetween(last, next);
    changes = coder.symbol(changes_, changes);
    Color now{};
    for (unsigned half = 0; half < 2; ++half) codeRed(coder, changes, half, last, next, now);
    if (changes & kColored) {
      for (unsigned half = 0; half < 2; ++half) codeOthers(coder, changes, half, last, next, now);
    } else {
      now[1] = now[2] = now[0];
    }
    last = now;
  }

 private:
  static constexpr unsigned kColored = 1u << 6;  // below it a bit for each byte: red, green, blue, the lower one first

  static int byteOf(std::uint16_t value, unsigned half) { return value >> (8 * half) & 0xff; }
  static void setByte(std::uint16_t& value, unsigned half, int byte) {
    value = static_cast<std::uint16_t>(value | (byte & 0xff) << (8 * half));
  }
  static unsigned changesBetween(const Color& last, const Color& next) {
    unsigned changes = next[0] != next[1] || next[0] != next[2] ? kColored : 0;
    for (unsigned k = 0; k < 6; ++k)
      if (byteOf(last[k / 2], k % 2) != byteOf(next[k / 2], k % 2)) changes |= 1u << k;
    return changes;
  }

  template <class Coder>
  void codeByte(Coder& coder, unsigned changes, unsigned k, int expected, const Color& last, const Color& next,
                Color& now) {
    const unsigned half = k % 2;
    int byte = byteOf(last[k / 2], half);
    if (changes & 1u << k) {
      const auto off = static_cast<unsigned>(byteOf(next[k / 2], half) - expected) & 0xffu;
      byte = expected + static_cast<int>(coder.symbol(bytes_[k], off));
    }
    setByte(now[k / 2], half, byte);
  }
  template <class Coder>
  void codeRed(Coder& coder, unsigned changes, unsigned half, const Color& last, const Color& next, Color& now) {
    codeByte(coder, changes, half, byteOf(last[0], half), last, next, now);
  }
  template <class Coder>
  void codeOthers(Coder& coder, unsigned changes, unsigned half, const Color& last, const Color& next, Color& now) {
    const auto within = [](int value) { return std::clamp(value, 0, 255); };
    const int red = byteOf(now[0], half) - byteOf(last[0], half);
    codeByte(coder, changes, 2 + half, within(red + byteOf(last[1], half)), last, next, now);
    const int both = (red + byteOf(now[1], half) - byteOf(last[1], half)) / 2;
    codeByte(coder, changes, 4 + half, within(both + byteOf(last[2], half)), last, next, now);
  }

  SymbolModel changes_{128};
  ByteModels<6> bytes_;
};

/// Infrared of 16 bits, by its two bytes.
class LazInfrared {
 public:
  template <class Coder>
  void code(Coder& coder, std::uint16_t& last, std::uint16_t next) {
    unsigned changes = 0;
    if constexpr (Coder::kEncodes) changes = ((last ^ next) & 0xff ? 1u : 0u) | ((last ^ next) >> 8 ? 2u : 0u);
    changes = coder.symbol(changes_, changes);
    unsigned now = 0;
    for (unsigned half = 0; half < 2; ++half) {
      unsigned byte = last >> (8 * half) & 0xffu;
      if (changes & 1u << half) byte += coder.symbol(bytes_[half], ((next >> (8 * half)) - byte) & 0xffu);
      now |= (byte & 0xffu) << (8 * half);
    }
    last = static_cast<std::uint16_t>(now);
  }

 private:
  SymbolModel changes_{4};
  ByteModels<2> bytes_;
};

/// A byte that nothing is known of.
template <class Coder>
void codeLazByte(Coder& coder, SymbolModel& model, std::byte& last, std::byte next) {
  const unsigned was = static_cast<unsigned>(last);
  const unsigned off = coder.symbol(model, (static_cast<unsigned>(next) - was) & 0xffu);
  last = static_cast<std::byte>((was + off) & 0xffu);
}

}  // namespace palpate
