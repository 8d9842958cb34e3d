// The points of formats 0 to 5 in LAZ, item by item in one stream (version 2 of LASzip's items).
#pragma once

#include <cstring>
#include <optional>

#include "engine/io/laz_items.hpp"
#include "engine/io/laz_layout.hpp"

namespace palpate {

/// The twenty bytes that all of these formats begin with.
struct LazCore10 {
  std::int32_t x, y, z;
  std::uint16_t intensity;
  std::uint8_t returns, classification, angle, user;
  std::uint16_t source;

  unsigned number() const { return returns & 7u; }
  unsigned count() const { return returns >> 3 & 7u; }
};
static_assert(sizeof(LazCore10) == 20);

/// Places, and what belongs to each return: what is expected comes from points of the same kind of return before.
class LazPoint10 {
 public:
  explicit LazPoint10(const LazCore10& first) : last_(first) { last_.intensity = 0; }

  template <class Coder>
  void code(Coder& coder, LazCore10& next) {
    unsigned changes = 0;
    if constexpr (Coder::kEncodes)
      changes = changesTo(next);
    else
      next = last_;
    changes = coder.symbol(changes_, changes);
    if (changes & kReturns) next.returns = byte(coder, returns_[last_.returns], next.returns);
    const unsigned kind = kKinds[next.count()][next.number()];
    codeOthers(coder, changes, kind, next);
    codePlace(coder, kind, next);
    last_ = next;
  }

 private:
  enum : unsigned { kSource = 1, kUser = 2, kAngle = 4, kClass = 8, kIntensity = 16, kReturns = 32 };
  // Of a return by how many there were (row) and which of them it is (column): those that are alike share what is
  // expected of them. Part of the format.
  static constexpr std::uint8_t kKinds[8][8] = {
      {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},    {13, 1, 2, 4, 7, 11, 11, 10},
      {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},   {10, 10, 11, 12, 13, 14, 14, 13},
      {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
  };

  unsigned changesTo(const LazCore10& next) const {
    const std::uint16_t intensity = intensities_[kKinds[next.count()][next.number()]];
    return (next.returns != last_.returns ? kReturns : 0u) | (next.intensity != intensity ? kIntensity : 0u) |
           (next.classification != last_.classification ? kClass : 0u) | (next.angle != last_.angle ? kAngle : 0u) |
           (next.user != last_.user ? kUser : 0u) | (next.source != last_.source ? kSource : 0u);
  }
  template <class Coder>
  static std::uint8_t byte(Coder& coder, SymbolModel& model, unsigned value) {
    return static_cast<std::uint8_t>(coder.symbol(model, value));
  }

  template <class Coder>
  void codeOthers(Coder& coder, unsigned changes, unsigned kind, LazCore10& next) {
    std::uint16_t& intensity = intensities_[kind];
    if (changes & kIntensity)
      intensity = static_cast<std::uint16_t>(intensity_.code(coder, intensity, next.intensity, std::min(kind, 3u)));
    next.intensity = intensity;
    if (changes & kClass) next.classification = byte(coder, classes_[last_.classification], next.classification);
    if (changes & kAngle) {
      const unsigned off = static_cast<unsigned>(next.angle - last_.angle) & 0xffu;
      next.angle = static_cast<std::uint8_t>(last_.angle + coder.symbol(angles_[next.returns >> 6 & 1u], off));
    }
    if (changes & kUser) next.user = byte(coder, users_[last_.user], next.user);
    if (changes & kSource) next.source = static_cast<std::uint16_t>(source_.code(coder, last_.source, next.source, 0));
  }

  template <class Coder>
  void codePlace(Coder& coder, unsigned kind, LazCore10& next) {
    const unsigned alone = next.count() == 1 ? 1 : 0;
    const auto step = [&](IntegerModel& model, StreamingMedian& usual, std::int32_t was, std::int32_t is,
                          unsigned context) {
      const std::int32_t off = model.code(coder, usual.get(), wrappedDifference(is, was), context);
      usual.add(off);
      return wrappedSum(was, off);
    };
    next.x = step(x_, stepsX_[kind], last_.x, next.x, alone);
    next.y = step(y_, stepsY_[kind], last_.y, next.y, alone + std::min(x_.lastLength() & ~1u, 20u));
    const unsigned length = (x_.lastLength() + y_.lastLength()) / 2;
    const auto off = static_cast<unsigned>(std::abs(static_cast<int>(next.count()) - static_cast<int>(next.number())));
    heights_[off] = z_.code(coder, heights_[off], next.z, alone + std::min(length & ~1u, 18u));
    next.z = heights_[off];
  }

  LazCore10 last_;
  SymbolModel changes_{64};
  ByteModels<256> returns_, classes_, users_;
  ByteModels<2> angles_;
  std::array<std::uint16_t, 16> intensities_{};  // of the last return of each kind
  std::array<StreamingMedian, 16> stepsX_{}, stepsY_{};
  std::array<std::int32_t, 8> heights_{};  // by how many returns are missing to the last one
  IntegerModel intensity_{16, 4}, source_{16, 1}, x_{32, 2}, y_{32, 22}, z_{32, 20};
};

/// A row of LAS with all that it has.
class LazRow10 {
 public:
  LazRow10(const LazLayout& layout, const std::byte* first)
      : layout_(layout),
        core_(load<LazCore10>(first)),
        bytes_(layout.extraBytes, SymbolModel(256)),
        lastBytes_(first + layout.bytesAt, first + layout.bytesAt + layout.extraBytes) {
    if (layout.timeAt) times_.emplace(load<std::int64_t>(first + layout.timeAt), true);
    if (layout.colorAt) lastColor_ = load<LazColors::Color>(first + layout.colorAt);
  }

  template <class Coder>
  void code(Coder& coder, std::byte* row) {
    LazCore10 core = load<LazCore10>(row);
    core_.code(coder, core);
    std::memcpy(row, &core, sizeof core);
    if (times_) {
      const std::int64_t time = times_->code(coder, load<std::int64_t>(row + layout_.timeAt));
      std::memcpy(row + layout_.timeAt, &time, sizeof time);
    }
    if (layout_.colorAt) {
      colors_.code(coder, lastColor_, load<LazColors::Color>(row + layout_.colorAt));
      std::memcpy(row + layout_.colorAt, &lastColor_, sizeof lastColor_);
    }
    if (bytes_.empty()) return;
    if constexpr (Coder::kEncodes) {
      codeBytes(coder, row + layout_.bytesAt);
    } else {
      Coder held = coder;  // in the processor's own memory from byte to byte
      codeBytes(held, row + layout_.bytesAt);
      coder = held;
    }
  }

 private:
  template <class T>
  static T load(const std::byte* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
  }

  template <class Coder>
  void codeBytes(Coder& coder, std::byte* bytes) {
    for (std::size_t k = 0; k < bytes_.size(); ++k) {
      codeLazByte(coder, bytes_[k], lastBytes_[k], bytes[k]);
      bytes[k] = lastBytes_[k];
    }
  }

  LazLayout layout_;
  LazPoint10 core_;
  std::optional<LazTimes> times_;
  LazColors colors_;
  LazColors::Color lastColor_{};
  std::vector<SymbolModel> bytes_;
  std::vector<std::byte> lastBytes_;
};

}  // namespace palpate
