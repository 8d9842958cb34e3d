// Codec for points of formats 0 to 5 in LAZ, item by item in one stream (version 2 of LASzip's items).
#pragma once

#include <cstring>
#include <optional>

#include "engine/io/laz_items.hpp"
#include "engine/io/laz_layout.hpp"

namespace palpate {

/// The first twenty bytes of all these formats.
struct LazCore10 {
  std::int32_t x, y, z;
  std::uint16_t intensity;
  std::uint8_t returns, classification, angle, user;
  std::uint16_t source;

  unsigned number() const { return returns & 7u; }
  unsigned count() const { return returns >> 3 & 7u; }
};
static_assert(sizeof(LazCore10) == 20);

/// Positions and the values of each return: predictions come from previous points with the same kind of return.
class LazPoint10 {
 public:
  explicit LazPoint10(const LazCore10& first) : last_(first) { last_.intensity = 0; }

  /// State of a point while it is coded step by step; an encoder sets all of it in the first step.
  struct Step {
    LazCore10 next{};
    unsigned changes = 0, kind = 0;
    IntegerModel::Number number{};  // the integer that is being coded
  };

  // The steps of coding a point, in their order. Steps of other streams may be interleaved.
  template <class Coder>
  [[gnu::always_inline]] void codeKind(Coder& coder, Step& step) {
    LazCore10& next = step.next;
    if constexpr (Coder::kEncodes)
      step.changes = changesTo(next);
    else
      next = last_;
    step.changes = coder.symbol(changes_, step.changes);
    if (step.changes & kReturns) next.returns = byte(coder, returns_[last_.returns], next.returns);
    step.kind = kKinds[next.count()][next.number()];
  }
  template <class Coder>
  [[gnu::always_inline]] void codeIntensityLength(Coder& coder, Step& step) {
    if (step.changes & kIntensity)
      intensity_.codeLength(coder, step.number, intensities_[step.kind], step.next.intensity, std::min(step.kind, 3u));
  }
  template <class Coder>
  [[gnu::always_inline]] void codeIntensityUpper(Coder& coder, Step& step) {
    if (step.changes & kIntensity) intensity_.codeUpper(coder, step.number);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeOthers(Coder& coder, Step& step) {
    LazCore10& next = step.next;
    if (step.changes & kIntensity)
      intensities_[step.kind] = static_cast<std::uint16_t>(intensity_.codeLower(coder, step.number));
    next.intensity = intensities_[step.kind];
    if ((step.changes & (kClass | kAngle | kUser | kSource)) == 0) return;
    if (step.changes & kClass) next.classification = byte(coder, classes_[last_.classification], next.classification);
    if (step.changes & kAngle) {
      const unsigned off = static_cast<unsigned>(next.angle - last_.angle) & 0xffu;
      next.angle = static_cast<std::uint8_t>(last_.angle + coder.symbol(angles_[next.returns >> 6 & 1u], off));
    }
    if (step.changes & kUser) next.user = byte(coder, users_[last_.user], next.user);
    if (step.changes & kSource)
      next.source = static_cast<std::uint16_t>(source_.code(coder, last_.source, next.source, 0));
  }
  template <class Coder>
  [[gnu::always_inline]] void codeLengthX(Coder& coder, Step& step) {
    const std::int32_t off = wrappedDifference(step.next.x, last_.x);
    x_.codeLength(coder, step.number, stepsX_[step.kind].get(), off, alone(step));
  }
  template <class Coder>
  [[gnu::always_inline]] void codeUpperX(Coder& coder, Step& step) {
    x_.codeUpper(coder, step.number);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeLowerX(Coder& coder, Step& step) {
    step.next.x = placeFrom(x_.codeLower(coder, step.number), stepsX_[step.kind], last_.x);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeLengthY(Coder& coder, Step& step) {
    const std::int32_t off = wrappedDifference(step.next.y, last_.y);
    const unsigned context = alone(step) + std::min(x_.lastLength() & ~1u, 20u);
    y_.codeLength(coder, step.number, stepsY_[step.kind].get(), off, context);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeUpperY(Coder& coder, Step& step) {
    y_.codeUpper(coder, step.number);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeLowerY(Coder& coder, Step& step) {
    step.next.y = placeFrom(y_.codeLower(coder, step.number), stepsY_[step.kind], last_.y);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeLengthZ(Coder& coder, Step& step) {
    const unsigned length = (x_.lastLength() + y_.lastLength()) / 2;
    z_.codeLength(coder, step.number, height(step), step.next.z, alone(step) + std::min(length & ~1u, 18u));
  }
  template <class Coder>
  [[gnu::always_inline]] void codeUpperZ(Coder& coder, Step& step) {
    z_.codeUpper(coder, step.number);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeLowerZ(Coder& coder, Step& step) {
    const std::int32_t z = z_.codeLower(coder, step.number);
    if constexpr (!Coder::kEncodes) step.next.z = z;
    height(step) = step.next.z;
    last_ = step.next;
  }

 private:
  enum : unsigned { kSource = 1, kUser = 2, kAngle = 4, kClass = 8, kIntensity = 16, kReturns = 32 };
  // Kind of a return by the number of returns (row) and its own number (column); returns of a kind share predictions.
  // Part of the format.
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
  [[gnu::always_inline]] static std::uint8_t byte(Coder& coder, SymbolModel& model, unsigned value) {
    return static_cast<std::uint8_t>(coder.symbol(model, value));
  }

  static unsigned alone(const Step& step) { return step.next.count() == 1 ? 1 : 0; }
  static std::int32_t placeFrom(std::int32_t off, StreamingMedian& usual, std::int32_t was) {
    usual.add(off);
    return wrappedSum(was, off);
  }
  std::int32_t& height(const Step& step) {
    const int missing = static_cast<int>(step.next.count()) - static_cast<int>(step.next.number());
    return heights_[static_cast<std::size_t>(std::abs(missing))];
  }

  LazCore10 last_;
  SymbolModel changes_{64};
  ByteModels<256> returns_, classes_, users_;
  ByteModels<2> angles_;
  std::array<std::uint16_t, 16> intensities_{};  // of the last return of each kind
  std::array<StreamingMedian, 16> stepsX_{}, stepsY_{};
  std::array<std::int32_t, 8> heights_{};  // by the number of returns behind it
  IntegerModel intensity_{16, 4}, source_{16, 1}, x_{32, 2}, y_{32, 22}, z_{32, 20};
};

/// Codec for a complete row of LAS.
class LazRow10 {
 public:
  LazRow10(const LazLayout& layout, const std::byte* first)
      : layout_(layout),
        core_(load<LazCore10>(first)),
        bytes_(layout.extraBytes, SymbolModel(256)),
        lastBytes_(first + layout.bytesAt, first + layout.bytesAt + layout.extraBytes) {
    if (layout.timeAt) times_.emplace(load<std::int64_t>(first + layout.timeAt), true);
    if (layout.colorAt) lastColor_ = load<LazColors::Color>(first + layout.colorAt);
    if (layout.wavesAt) waves_.emplace(first + layout.wavesAt);
  }

  /// A row of one of the chunks that are coded in parallel.
  template <class Coder>
  struct Lane {
    LazRow10& row;
    Coder& coder;
    std::byte* at;
    LazPoint10::Step core{};
    LazTimes::Step time{};
    LazColors::Step color{};
  };

  /// Maximum number of calls of a coder for a row.
  std::size_t mostCalls() const { return 40 + (layout_.wavesAt ? LazWaves::kMaxCalls : 0) + layout_.extraBytes; }

  /// Codes the next row of each lane, all with the same layout. Within a lane each step depends on the previous one;
  /// interleaving the lanes gives the processor independent work.
  template <class... Lanes>
  [[gnu::always_inline]] static void code(const LazLayout& layout, Lanes&... lanes) {
    (lanes.row.load(lanes), ...);
    (lanes.row.core_.codeKind(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeIntensityLength(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeIntensityUpper(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeOthers(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeLengthX(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeUpperX(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeLowerX(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeLengthY(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeUpperY(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeLowerY(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeLengthZ(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeUpperZ(lanes.coder, lanes.core), ...);
    (lanes.row.core_.codeLowerZ(lanes.coder, lanes.core), ...);
    (store(lanes.core.next, lanes.at), ...);
    if (layout.timeAt) {
      (lanes.row.times_->codeSymbol(lanes.coder, lanes.time), ...);
      (lanes.row.times_->codeLength(lanes.coder, lanes.time), ...);
      (lanes.row.times_->codeUpper(lanes.coder, lanes.time), ...);
      (lanes.row.finishTime(lanes), ...);
    }
    if (layout.colorAt) {
      (lanes.row.colors_.codeChanges(lanes.coder, lanes.color, lanes.row.lastColor_), ...);
      (lanes.row.colors_.codeRed(lanes.coder, lanes.color, lanes.row.lastColor_, 0), ...);
      (lanes.row.colors_.codeRed(lanes.coder, lanes.color, lanes.row.lastColor_, 1), ...);
      (lanes.row.colors_.codeGreen(lanes.coder, lanes.color, lanes.row.lastColor_, 0), ...);
      (lanes.row.colors_.codeBlue(lanes.coder, lanes.color, lanes.row.lastColor_, 0), ...);
      (lanes.row.colors_.codeGreen(lanes.coder, lanes.color, lanes.row.lastColor_, 1), ...);
      (lanes.row.colors_.codeBlue(lanes.coder, lanes.color, lanes.row.lastColor_, 1), ...);
      (lanes.row.finishColor(lanes), ...);
    }
    if (layout.wavesAt) (lanes.row.waves_->code(lanes.coder, lanes.at + layout.wavesAt), ...);
    for (std::size_t k = 0; k < layout.extraBytes; ++k) (lanes.row.codeByte(lanes, k), ...);
  }

 private:
  template <class T>
  static T load(const std::byte* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
  }

  template <class Coder>
  [[gnu::always_inline]] void load(Lane<Coder>& lane) const {
    if constexpr (Coder::kEncodes) {
      lane.core.next = load<LazCore10>(lane.at);
      if (layout_.timeAt) lane.time.time = load<std::int64_t>(lane.at + layout_.timeAt);
      if (layout_.colorAt) lane.color.next = load<LazColors::Color>(lane.at + layout_.colorAt);
    }
  }
  /// Field by field: loading a whole struct soon after its parts were stored stalls until they are in memory.
  [[gnu::always_inline]] static void store(const LazCore10& core, std::byte* at) {
    std::memcpy(at, &core.x, sizeof core.x);
    std::memcpy(at + 4, &core.y, sizeof core.y);
    std::memcpy(at + 8, &core.z, sizeof core.z);
    std::memcpy(at + 12, &core.intensity, sizeof core.intensity);
    std::memcpy(at + 14, &core.returns, sizeof core.returns);
    std::memcpy(at + 15, &core.classification, sizeof core.classification);
    std::memcpy(at + 16, &core.angle, sizeof core.angle);
    std::memcpy(at + 17, &core.user, sizeof core.user);
    std::memcpy(at + 18, &core.source, sizeof core.source);
  }
  template <class Coder>
  [[gnu::always_inline]] void finishTime(Lane<Coder>& lane) {
    const std::int64_t time = times_->codeLower(lane.coder, lane.time);
    std::memcpy(lane.at + layout_.timeAt, &time, sizeof time);
  }
  template <class Coder>
  [[gnu::always_inline]] void finishColor(Lane<Coder>& lane) {
    colors_.finish(lane.color, lastColor_);
    std::memcpy(lane.at + layout_.colorAt, &lastColor_, sizeof lastColor_);
  }
  template <class Coder>
  [[gnu::always_inline]] void codeByte(Lane<Coder>& lane, std::size_t k) {
    std::byte& byte = lane.at[layout_.bytesAt + k];
    codeLazByte(lane.coder, bytes_[k], lastBytes_[k], byte);
    byte = lastBytes_[k];
  }

  LazLayout layout_;
  LazPoint10 core_;
  std::optional<LazTimes> times_;
  LazColors colors_;
  LazColors::Color lastColor_{};
  std::optional<LazWaves> waves_;
  std::vector<SymbolModel> bytes_;
  std::vector<std::byte> lastBytes_;
};

}  // namespace palpate
