// Codec for points of formats 6 to 10 in LAZ, in layers: a stream for each group of values that change together, so
// that a program can skip unneeded ones; a layer without changes is omitted (versions 3 and 4 of LASzip's items). Each
// of a scanner's four channels has its own models and last point.
#pragma once

#include <cstring>
#include <memory>
#include <optional>

#include "engine/io/laz_items.hpp"
#include "engine/io/laz_layout.hpp"

namespace palpate {

inline constexpr std::size_t kLazChannels = 4;

/// A stream, and whether it has changes; for a decoder: whether it is present.
template <class Coder>
struct LazLayer {
  Coder coder;
  bool changes = false;

  /// Whether a value is coded in this layer: an encoder codes all values, and records whether any differs.
  bool codes(bool differs) {
    if constexpr (Coder::kEncodes) {
      changes |= differs;
      return true;
    } else {
      return changes;
    }
  }
};

/// The layers of positions and of the values of each return, in their order.
enum class LazLayer14 : std::size_t { places, heights, classes, flags, intensities, angles, users, sources, times };
inline constexpr std::size_t kLazLayers14 = 9;

struct LazCore14 {
  std::int32_t x, y, z;
  std::uint16_t intensity;
  std::uint8_t returns, bits, classification, user;
  std::int16_t angle;
  std::uint16_t source;
  // Size in rows; sizeof includes padding.
  static constexpr std::size_t kBytes = 22;

  unsigned number() const { return returns & 15u; }
  unsigned count() const { return returns >> 4; }
  unsigned channel() const { return bits >> 4 & 3u; }
  /// Flags of the classification, and above them the scan direction and the edge of a flight line.
  unsigned flags() const { return (bits & 15u) | (bits >> 2 & 0x30u); }
  void setFlags(unsigned flags) {
    bits = static_cast<std::uint8_t>((bits & 0x30u) | (flags & 15u) | (flags & 0x30u) << 2);
  }
  void setChannel(unsigned channel) { bits = static_cast<std::uint8_t>((bits & 0xcfu) | channel << 4); }
};

template <class Coder>
class LazPoint14 {
 public:
  using Layers = std::span<LazLayer<Coder>>;

  /// `layers`: kLazLayers14, which must outlive the object.
  LazPoint14(Layers layers, const LazCore14& first, std::int64_t firstTime)
      : layers_(layers), channel_(first.channel()) {
    channels_[channel_] = std::make_unique<Channel>(first, firstTime);
  }

  unsigned channel() const { return channel_; }                  ///< of the last point
  bool hasChangedChannel() const { return hasChangedChannel_; }  ///< at the last point

  void code(LazCore14& next, std::int64_t& time) {
    Coder& places = coder(LazLayer14::places);
    const Channel& before = *channels_[channel_];
    unsigned changes = 0;
    if constexpr (Coder::kEncodes) changes = changesTo(next, time);
    changes = places.symbol(channels_[channel_]->changes[before.kindOfLast()], changes);
    hasChangedChannel_ = changes & kChannel;
    if (hasChangedChannel_) changeChannel(places, next.channel());
    Channel& now = *channels_[channel_];
    if constexpr (!Coder::kEncodes) next = now.last, time = now.lastTime;
    codeReturns(places, now, changes, next);
    const bool later = changes & kTime;
    codePlace(places, now, later, next);
    codeOthers(now, changes, next);
    if (layer(LazLayer14::times).codes(later) && later) time = now.times.code(coder(LazLayer14::times), time);
    now.last = next;
    now.lastTime = time;
    now.timeChanged = later;
  }

 private:
  // The lowest two bits tell how the return number differs: not, by +1, by -1, otherwise.
  enum : unsigned { kNumber = 3, kCount = 4, kAngle = 8, kTime = 16, kSource = 32, kChannel = 64 };

  struct Channel {
    Channel(const LazCore14& first, std::int64_t time) : last(first), lastTime(time), times(time, false) {
      heights.fill(first.z);
      intensities.fill(first.intensity);
    }
    unsigned kindOfLast() const {
      return (last.number() == 1 ? 1u : 0u) + (last.number() >= last.count() ? 2u : 0u) + (timeChanged ? 4u : 0u);
    }

    LazCore14 last;
    std::int64_t lastTime = 0;
    bool timeChanged = false;
    ByteModels<8> changes{128};
    SymbolModel channel{3}, numberSameTime{13};
    ByteModels<16> counts{16}, numbers{16};
    ByteModels<64> classes{256}, flags{64}, users{256};
    std::array<StreamingMedian, 12> stepsX{}, stepsY{};  // by kind of return, and whether the time has changed
    std::array<std::int32_t, 8> heights{};
    std::array<std::uint16_t, 8> intensities{};
    IntegerModel x{32, 2}, y{32, 22}, z{32, 20}, intensity{16, 4}, angle{16, 2}, source{16, 1};
    LazTimes times;
  };

  LazLayer<Coder>& layer(LazLayer14 which) { return layers_[static_cast<std::size_t>(which)]; }
  Coder& coder(LazLayer14 which) { return layer(which).coder; }

  unsigned changesTo(const LazCore14& next, std::int64_t time) const {
    const unsigned channel = next.channel();
    const Channel& known = channels_[channel] ? *channels_[channel] : *channels_[channel_];
    const LazCore14& last = known.last;
    const unsigned more = (next.number() - last.number()) & 15u;
    return (more == 0    ? 0u
            : more == 1  ? 1u
            : more == 15 ? 2u
                         : 3u) |
           (next.count() != last.count() ? kCount : 0u) | (next.angle != last.angle ? kAngle : 0u) |
           (time != known.lastTime ? kTime : 0u) | (next.source != last.source ? kSource : 0u) |
           (channel != channel_ ? kChannel : 0u);
  }

  void changeChannel(Coder& places, unsigned next) {
    const unsigned ahead = places.symbol(channels_[channel_]->channel, ((next - channel_) & 3u) - 1);
    const unsigned channel = (channel_ + ahead + 1) & 3u;
    if (!channels_[channel])
      channels_[channel] = std::make_unique<Channel>(channels_[channel_]->last, channels_[channel_]->lastTime);
    channel_ = channel;
    channels_[channel]->last.setChannel(channel);
  }

  void codeReturns(Coder& places, Channel& now, unsigned changes, LazCore14& next) {
    const unsigned lastNumber = now.last.number();
    unsigned count = now.last.count(), number = lastNumber;
    if (changes & kCount) count = places.symbol(now.counts[count], next.count());
    switch (changes & kNumber) {
      case 1:
        number = (number + 1) & 15u;
        break;
      case 2:
        number = (number + 15) & 15u;
        break;
      case 3:
        if (changes & kTime)
          number = places.symbol(now.numbers[lastNumber], next.number());
        else
          number = (lastNumber + places.symbol(now.numberSameTime, ((next.number() - lastNumber) & 15u) - 2) + 2) & 15u;
        break;
      default:
        break;
    }
    next.returns = static_cast<std::uint8_t>(count << 4 | number);
  }

  void codePlace(Coder& places, Channel& now, bool later, LazCore14& next) {
    const unsigned alone = next.count() == 1 ? 1 : 0;
    const unsigned kind = 2u * kKinds[next.count()][next.number()] + (later ? 1u : 0u);
    const auto step = [&](IntegerModel& model, StreamingMedian& usual, std::int32_t was, std::int32_t is,
                          unsigned context) {
      const std::int32_t off = model.code(places, usual.get(), wrappedDifference(is, was), context);
      usual.add(off);
      return wrappedSum(was, off);
    };
    next.x = step(now.x, now.stepsX[kind], now.last.x, next.x, alone);
    next.y = step(now.y, now.stepsY[kind], now.last.y, next.y, alone + std::min(now.x.lastLength() & ~1u, 20u));
    LazLayer<Coder>& heights = layer(LazLayer14::heights);
    if (!heights.codes(true)) return;
    const unsigned length = (now.x.lastLength() + now.y.lastLength()) / 2;
    const auto off = std::abs(static_cast<int>(next.count()) - static_cast<int>(next.number()));
    std::int32_t& height = now.heights[static_cast<std::size_t>(std::min(off, 7))];
    height = now.z.code(heights.coder, height, next.z, alone + std::min(length & ~1u, 18u));
    next.z = height;
  }

  void codeOthers(Channel& now, unsigned changes, LazCore14& next) {
    const LazCore14 last = now.last;
    const unsigned kind = (next.number() == 1 ? 1u : 0u) + (next.number() >= next.count() ? 2u : 0u);
    const unsigned later = changes & kTime ? 1 : 0;
    const auto byte = [&](LazLayer14 which, SymbolModel& model, unsigned value) {
      return static_cast<std::uint8_t>(coder(which).symbol(model, value));
    };
    if (layer(LazLayer14::classes).codes(next.classification != last.classification)) {
      SymbolModel& model = now.classes[(last.classification & 31u) * 2 + (kind == 3 ? 1 : 0)];
      next.classification = byte(LazLayer14::classes, model, next.classification);
    }
    if (layer(LazLayer14::flags).codes(next.flags() != last.flags()))
      next.setFlags(byte(LazLayer14::flags, now.flags[last.flags()], next.flags()));
    if (layer(LazLayer14::intensities).codes(next.intensity != last.intensity)) {
      std::uint16_t& usual = now.intensities[2 * kind + later];
      usual =
          static_cast<std::uint16_t>(now.intensity.code(coder(LazLayer14::intensities), usual, next.intensity, kind));
      next.intensity = usual;
    }
    const bool turned = changes & kAngle, other = changes & kSource;
    if (layer(LazLayer14::angles).codes(turned) && turned)
      next.angle = static_cast<std::int16_t>(now.angle.code(coder(LazLayer14::angles), last.angle, next.angle, later));
    if (layer(LazLayer14::users).codes(next.user != last.user))
      next.user = byte(LazLayer14::users, now.users[last.user / 4], next.user);
    if (layer(LazLayer14::sources).codes(other) && other)
      next.source =
          static_cast<std::uint16_t>(now.source.code(coder(LazLayer14::sources), last.source, next.source, 0));
  }

  // Kind of a return by the number of returns (row) and its own number (column); returns of a kind share predictions.
  // Part of the format.
  static constexpr std::uint8_t kKinds[16][16] = {
      {0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5}, {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
      {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3}, {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
      {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
      {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
      {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
      {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
      {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
      {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5},
  };

  Layers layers_;
  unsigned channel_ = 0;
  bool hasChangedChannel_ = false;
  std::array<std::unique_ptr<Channel>, kLazChannels> channels_;
};

/// State of another item for each channel: models, and the last value.
template <class Models, class Value>
class LazChannels {
 public:
  struct Channel {
    Models models;
    Value last;
  };
  struct Picked {
    Models& models;
    Value& last;
  };

  /// `lag`: when a channel recurs, the last value is still that of the previous channel, as in version 3.
  LazChannels(bool lag, unsigned channel, Models models, Value first) : fresh_(models), lag_(lag), current_(channel) {
    channels_[channel] = std::make_unique<Channel>(Channel{std::move(models), std::move(first)});
  }

  Picked pick(unsigned channel) {
    Channel* last = channels_[current_].get();
    if (channel != current_) {
      const bool known = channels_[channel] != nullptr;
      if (!known) channels_[channel] = std::make_unique<Channel>(Channel{fresh_, last->last});
      if (!known || !lag_) last = channels_[channel].get();
      current_ = channel;
    }
    return {channels_[channel]->models, last->last};
  }

 private:
  Models fresh_;
  bool lag_;
  unsigned current_;
  std::array<std::unique_ptr<Channel>, kLazChannels> channels_;
};

/// Codec for a complete row of LAS. `layers`: all layers of the layout; they must outlive the object.
template <class Coder>
class LazRow14 {
 public:
  LazRow14(const LazLayout& layout, std::span<LazLayer<Coder>> layers, const std::byte* first)
      : layout_(layout), layers_(layers), core_(layers.first(kLazLayers14), coreAt(first), timeAt(first)) {
    const unsigned channel = core_.channel();
    if (layout.colorAt)
      colors_.emplace(layout.channelsLag, channel, LazColors(), load<LazColors::Color>(first + layout.colorAt));
    if (layout.infraredAt)
      infrared_.emplace(layout.channelsLag, channel, LazInfrared(), load<std::uint16_t>(first + layout.infraredAt));
    if (layout.extraBytes > 0)
      bytes_.emplace(layout.channelsLag, channel, std::vector<SymbolModel>(layout.extraBytes),
                     std::vector<std::byte>(first + layout.bytesAt, first + layout.rowBytes));
  }

  void code(std::byte* row) {
    LazCore14 core = coreAt(row);
    std::int64_t time = timeAt(row);
    core_.code(core, time);
    std::memcpy(row, &core, LazCore14::kBytes);
    std::memcpy(row + layout_.timeAt, &time, sizeof time);
    // In version 3 only the first point of a channel has the right channel for other items; for the following ones they
    // use channel 0.
    const unsigned channel = layout_.channelsLag && !core_.hasChangedChannel() ? 0 : core_.channel();
    std::size_t layer = kLazLayers14;
    if (colors_) codeColor(channel, row + layout_.colorAt, layers_[layer++]);
    if (infrared_) codeInfrared(channel, row + layout_.infraredAt, layers_[layer++]);
    if (layout_.wavesAt) {  // their layer is skipped, since waveforms usually are in another file
      std::memset(row + layout_.wavesAt, 0, kLazWaveBytes);
      ++layer;
    }
    if (bytes_) codeBytes(channel, row + layout_.bytesAt, layers_.subspan(layer));
  }

 private:
  template <class T>
  static T load(const std::byte* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  static LazCore14 coreAt(const std::byte* row) {
    LazCore14 core;
    std::memcpy(&core, row, LazCore14::kBytes);
    return core;
  }
  std::int64_t timeAt(const std::byte* row) const { return load<std::int64_t>(row + layout_.timeAt); }

  void codeColor(unsigned channel, std::byte* at, LazLayer<Coder>& layer) {
    const auto [models, last] = colors_->pick(channel);
    const auto next = load<LazColors::Color>(at);
    if (layer.codes(next != last)) models.code(layer.coder, last, next);
    std::memcpy(at, &last, sizeof last);
  }
  void codeInfrared(unsigned channel, std::byte* at, LazLayer<Coder>& layer) {
    const auto [models, last] = infrared_->pick(channel);
    const auto next = load<std::uint16_t>(at);
    if (layer.codes(next != last)) models.code(layer.coder, last, next);
    std::memcpy(at, &last, sizeof last);
  }
  void codeBytes(unsigned channel, std::byte* at, std::span<LazLayer<Coder>> layers) {
    const auto [models, last] = bytes_->pick(channel);
    for (std::size_t k = 0; k < layout_.extraBytes; ++k) {
      if (layers[k].codes(at[k] != last[k])) {
        if (!models[k].isMade()) models[k] = SymbolModel(256);
        codeLazByte(layers[k].coder, models[k], last[k], at[k]);
      }
      at[k] = last[k];
    }
  }

  LazLayout layout_;
  std::span<LazLayer<Coder>> layers_;
  LazPoint14<Coder> core_;
  std::optional<LazChannels<LazColors, LazColors::Color>> colors_;
  std::optional<LazChannels<LazInfrared, std::uint16_t>> infrared_;
  std::optional<LazChannels<std::vector<SymbolModel>, std::vector<std::byte>>> bytes_;
};

}  // namespace palpate
