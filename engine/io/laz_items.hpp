// Codecs for the parts of LAZ points besides positions: times, colours, infrared and bytes, predicted from the previous
// point (Isenburg 2013). Each codec has one function for both directions (range_coder.hpp): an encoder receives the
// values, a decoder writes them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "engine/io/integer_model.hpp"

namespace palpate {

/// 32-bit integers with wrap-around, which occurs in damaged files.
inline std::int32_t wrappedSum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}
inline std::int32_t wrappedDifference(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}
inline std::int32_t wrappedProduct(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(b));
}

/// Models of 256 symbols, created at their first use.
template <std::size_t count>
class ByteModels {
 public:
  SymbolModel& operator[](std::size_t k) {
    if (!models_[k].isMade()) [[unlikely]]
      make(models_[k]);
    return models_[k];
  }
  [[gnu::noinline]] void make(SymbolModel& model) { model = SymbolModel(symbols_); }
  explicit ByteModels(unsigned symbols = 256) : symbols_(symbols) {}

 private:
  std::array<SymbolModel, count> models_;
  unsigned symbols_;
};

/// Approximate median of recent numbers: keeps five sorted numbers; each insertion drops the smallest or the largest.
class StreamingMedian {
 public:
  std::int32_t get() const { return sorted_[2]; }
  /// Inserts into the four numbers kept, without a branch, since the position is unpredictable.
  void add(std::int32_t v) {
    const std::int32_t* const four = sorted_.data() + (forgetsLargest_ ? 0 : 1);
    const std::int32_t a = four[0], b = four[1], c = four[2], d = four[3];
    const bool less = v < sorted_[2], same = v == sorted_[2];
    forgetsLargest_ = less | (same & !forgetsLargest_);
    sorted_ = {lesser(a, v), larger(a, lesser(b, v)), larger(b, lesser(c, v)), larger(c, lesser(d, v)), larger(d, v)};
  }

 private:
  // Compilers sometimes generate branches for std::min().
  static std::int32_t lesser(std::int32_t a, std::int32_t b) {
    return b ^ ((a ^ b) & -static_cast<std::int32_t>(a < b));
  }
  static std::int32_t larger(std::int32_t a, std::int32_t b) {
    return b ^ ((a ^ b) & -static_cast<std::int32_t>(a > b));
  }

  std::array<std::int32_t, 5> sorted_{};
  bool forgetsLargest_ = true;
};

/// Times, coded as integers of their bits: a scanner's times grow by the same step or by multiples of it; up to four
/// sequences (scanners) may alternate.
class LazTimes {
 public:
  /// `mayStay`: an unchanged time has a symbol of its own, as in version 2; version 3 codes this elsewhere.
  LazTimes(std::int64_t first, bool mayStay)
      : stays_(mayStay ? 1 : 0), plain_(5u + stays_), multiple_(kOwn + 4u + stays_) {
    sequences_[0].time = first;
  }

  enum class Kind { stays, second, multiple, begins };  // second: of a sequence without a step
  /// State of a time while it is coded step by step; an encoder sets all of it in the first step.
  struct Step {
    std::int64_t time = 0;
    Kind kind = Kind::stays;
    unsigned symbol = 0;
    IntegerModel::Number number{};
  };

  // The steps of coding a time, in their order. Steps of other streams may be interleaved.
  template <class Coder>
  [[gnu::always_inline]] void codeSymbol(Coder& coder, Step& step) {
    step.kind = Kind::stays;
    for (int turns = 0; turns < 2; ++turns) {  // an encoder switches to another sequence at most once
      const bool fresh = sequences_[current_].step == 0;
      // Symbols below `own` are differences to the sequence's last time; the following ones: unchanged time, new
      // sequence, another sequence.
      const unsigned own = fresh ? 0 : kOwn;
      if constexpr (Coder::kEncodes) step.symbol = symbolFor(step.time, own);
      step.symbol = coder.symbol(fresh ? plain_ : multiple_, step.symbol);
      if (stays_ && step.symbol == own) return;
      if (fresh && step.symbol == stays_) {
        step.kind = Kind::second;
        return;
      }
      if (step.symbol < own) {
        step.kind = Kind::multiple;
        return;
      }
      const unsigned other = step.symbol - own - stays_ - (fresh ? 1 : 0);
      if (other == 0) {
        step.kind = Kind::begins;
        return;
      }
      current_ = (current_ + other) & 3;
    }
    coder.setWrong();
  }
  template <class Coder>
  [[gnu::always_inline]] void codeLength(Coder& coder, Step& step) {
    if (step.kind == Kind::stays) return;
    const Sequence& now = sequences_[current_];
    std::int32_t expected = 0, value = static_cast<std::int32_t>(bitsOff(step.time, now));
    unsigned context = 0;
    if (step.kind == Kind::multiple) {
      expected = wrappedProduct(timesOf(step.symbol), now.step);
      context = contextOf(step.symbol);
    } else if (step.kind == Kind::begins) {
      expected = upper(now.time), value = upper(step.time);
      context = 8;
    }
    difference_.codeLength(coder, step.number, expected, value, context);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeUpper(Coder& coder, Step& step) {
    if (step.kind != Kind::stays) difference_.codeUpper(coder, step.number);
  }
  /// Returns the time.
  template <class Coder>
  [[gnu::always_inline]] std::int64_t codeLower(Coder& coder, Step& step) {
    Sequence& now = sequences_[current_];
    if (step.kind == Kind::stays) return now.time;
    const std::int32_t off = difference_.codeLower(coder, step.number);
    if (step.kind == Kind::begins) return begin(off, coder.bits(32, static_cast<std::uint32_t>(step.time)));
    if (step.symbol == 1 || step.kind == Kind::second) now.extremes = 0;
    if (step.kind == Kind::second) now.step = off;
    if (step.kind == Kind::multiple && isExtreme(step.symbol) && ++now.extremes > kMaxExtremes) {
      now.step = off;
      now.extremes = 0;
    }
    return advance(now, off);
  }

  /// All steps in sequence.
  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t time) {
    Step step{.time = time};
    codeSymbol(coder, step);
    codeLength(coder, step);
    codeUpper(coder, step);
    return codeLower(coder, step);
  }

 private:
  static constexpr unsigned kMaxTimes = 500, kMaxBack = 10, kOwn = kMaxTimes + kMaxBack + 1;
  static constexpr int kMaxExtremes = 3;  // steps that fit no multiple; then the step is replaced

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
    if (times >= 0) return static_cast<unsigned>(std::min(times, double{kMaxTimes}));
    return kMaxTimes + static_cast<unsigned>(std::min(-times, double{kMaxBack}));
  }

  static std::int32_t upper(std::int64_t time) {
    return static_cast<std::int32_t>(static_cast<std::uint64_t>(time) >> 32);
  }
  static std::int32_t timesOf(unsigned symbol) {
    const auto times = static_cast<std::int32_t>(symbol);
    return symbol > kMaxTimes ? static_cast<std::int32_t>(kMaxTimes) - times : times;
  }
  static bool isExtreme(unsigned symbol) {
    return symbol == 0 || symbol == kMaxTimes || symbol == kMaxTimes + kMaxBack;
  }
  /// Context for the size of the multiple.
  static unsigned contextOf(unsigned symbol) {
    return symbol == 0                      ? 7u
           : symbol == 1                    ? 1u
           : symbol < 10                    ? 2u
           : symbol < kMaxTimes             ? 3u
           : symbol == kMaxTimes            ? 4u
           : symbol == kMaxTimes + kMaxBack ? 6u
                                            : 5u;
  }

  std::int64_t begin(std::int32_t high, std::uint32_t low) {
    newest_ = (newest_ + 1) & 3;
    current_ = newest_;
    const std::uint64_t whole = std::uint64_t{static_cast<std::uint32_t>(high)} << 32 | low;
    sequences_[current_] = {static_cast<std::int64_t>(whole), 0, 0};
    return sequences_[current_].time;
  }

  unsigned stays_;  // 1 if mayStay, else 0
  SymbolModel plain_, multiple_;
  IntegerModel difference_{32, 9};
  std::array<Sequence, 4> sequences_{};
  unsigned current_ = 0, newest_ = 0;
};

/// 16-bit colours, coded by bytes: green is predicted from the change of red, blue from both. Grey has a flag.
class LazColors {
 public:
  using Color = std::array<std::uint16_t, 3>;

  /// State of a colour while it is coded step by step; an encoder sets `next` before the first step.
  struct Step {
    Color next{}, now{};
    unsigned changes = 0;
  };

  // The steps of coding a colour, in their order: changes; then red, green and blue, the lower byte of each before the
  // upper one (`half`), but both of red first. Steps of other streams may be interleaved.
  template <class Coder>
  [[gnu::always_inline]] void codeChanges(Coder& coder, Step& step, const Color& last) {
    if constexpr (Coder::kEncodes) step.changes = changesBetween(last, step.next);
    step.changes = coder.symbol(changes_, step.changes);
    step.now = {};
  }
  template <class Coder>
  [[gnu::always_inline]] void codeRed(Coder& coder, Step& step, const Color& last, unsigned half) {
    codeByte(coder, step, half, byteOf(last[0], half), last);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeGreen(Coder& coder, Step& step, const Color& last, unsigned half) {
    if (!(step.changes & kColored)) return;
    codeByte(coder, step, 2 + half, within(redChange(step, last, half) + byteOf(last[1], half)), last);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeBlue(Coder& coder, Step& step, const Color& last, unsigned half) {
    if (!(step.changes & kColored)) return;
    const int both = (redChange(step, last, half) + byteOf(step.now[1], half) - byteOf(last[1], half)) / 2;
    codeByte(coder, step, 4 + half, within(both + byteOf(last[2], half)), last);
  }
  /// Copies the colour to `last`.
  void finish(Step& step, Color& last) const {
    if (!(step.changes & kColored)) step.now[1] = step.now[2] = step.now[0];
    last = step.now;
  }

  /// All steps in sequence.
  template <class Coder>
  void code(Coder& coder, Color& last, const Color& next) {
    Step step{.next = next};
    codeChanges(coder, step, last);
    for (unsigned half = 0; half < 2; ++half) codeRed(coder, step, last, half);
    for (unsigned half = 0; half < 2; ++half) codeGreen(coder, step, last, half), codeBlue(coder, step, last, half);
    finish(step, last);
  }

 private:
  static constexpr unsigned kColored = 1u << 6;  // lower bits: changed bytes of red, green, blue, the lower byte first

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

  static int within(int value) { return std::clamp(value, 0, 255); }
  static int redChange(const Step& step, const Color& last, unsigned half) {
    return byteOf(step.now[0], half) - byteOf(last[0], half);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeByte(Coder& coder, Step& step, unsigned k, int expected, const Color& last) {
    const unsigned half = k % 2;
    int byte = byteOf(last[k / 2], half);
    if (step.changes & 1u << k) {
      const auto off = static_cast<unsigned>(byteOf(step.next[k / 2], half) - expected) & 0xffu;
      byte = expected + static_cast<int>(coder.symbol(bytes_[k], off));
    }
    setByte(step.now[k / 2], half, byte);
  }

  SymbolModel changes_{128};
  ByteModels<6> bytes_;
};

/// 16-bit infrared, coded as two bytes.
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

/// Position of a point's wave packet, and its parameters: 29 bytes. Packets usually follow one another.
class LazWaves {
 public:
  static constexpr std::size_t kMaxCalls = 26;  // of a coder

  explicit LazWaves(const std::byte* first) { last_ = load(first); }

  /// Codes the bytes of the next point.
  template <class Coder>
  [[gnu::always_inline]] void code(Coder& coder, std::byte* at) {
    Packet next = last_;
    if constexpr (Coder::kEncodes) next = load(at);
    next.descriptor = static_cast<std::uint8_t>(coder.symbol(descriptors_, next.descriptor));
    kind_ = coder.symbol(kinds_[kind_], kindOf(next));
    if (kind_ == 0) next.offset = last_.offset;
    if (kind_ == 1) next.offset = last_.offset + static_cast<std::uint32_t>(last_.numbers[0]);
    if (kind_ == 2) {
      step_ = steps_.code(coder, step_, static_cast<std::int32_t>(next.offset - last_.offset), 0);
      next.offset = last_.offset + static_cast<std::uint64_t>(std::int64_t{step_});
    }
    if (kind_ == 3) {
      const std::uint32_t low = coder.bits(32, static_cast<std::uint32_t>(next.offset));
      next.offset = std::uint64_t{coder.bits(32, static_cast<std::uint32_t>(next.offset >> 32))} << 32 | low;
    }
    next.numbers[0] = sizes_.code(coder, last_.numbers[0], next.numbers[0], 0);
    next.numbers[1] = places_.code(coder, last_.numbers[1], next.numbers[1], 0);
    for (unsigned k = 0; k < 3; ++k)
      next.numbers[2 + k] = directions_.code(coder, last_.numbers[2 + k], next.numbers[2 + k], k);
    last_ = next;
    store(next, at);
  }

 private:
  struct Packet {
    std::uint8_t descriptor = 0;
    std::uint64_t offset = 0;
    std::array<std::int32_t, 5> numbers{};  // size; position of the return in the packet; direction, as bits of floats
  };

  /// Distance of the packet from the previous one: zero, directly behind it, 32 bits, or 64 bits.
  unsigned kindOf(const Packet& next) const {
    const std::uint64_t off = next.offset - last_.offset;
    if (off == 0) return 0;
    if (off == static_cast<std::uint32_t>(last_.numbers[0])) return 1;
    return static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(off)}) == off ? 2 : 3;
  }
  static Packet load(const std::byte* at) {
    Packet packet;
    std::memcpy(&packet.descriptor, at, 1);
    std::memcpy(&packet.offset, at + 1, sizeof packet.offset);
    std::memcpy(packet.numbers.data(), at + 9, sizeof packet.numbers);
    return packet;
  }
  static void store(const Packet& packet, std::byte* at) {
    std::memcpy(at, &packet.descriptor, 1);
    std::memcpy(at + 1, &packet.offset, sizeof packet.offset);
    std::memcpy(at + 9, packet.numbers.data(), sizeof packet.numbers);
  }

  SymbolModel descriptors_{256};
  std::array<SymbolModel, 4> kinds_{SymbolModel(4), SymbolModel(4), SymbolModel(4), SymbolModel(4)};
  IntegerModel steps_{32, 1}, sizes_{32, 1}, places_{32, 1}, directions_{32, 3};
  Packet last_;
  std::int32_t step_ = 0;
  unsigned kind_ = 0;
};

/// A byte of unknown meaning.
template <class Coder>
[[gnu::always_inline]] inline void codeLazByte(Coder& coder, SymbolModel& model, std::byte& last, std::byte next) {
  const unsigned was = static_cast<unsigned>(last);
  const unsigned off = coder.symbol(model, (static_cast<unsigned>(next) - was) & 0xffu);
  last = static_cast<std::byte>((was + off) & 0xffu);
}

}  // namespace palpate
