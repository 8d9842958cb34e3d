#include "engine/io/laz_chunk.hpp"

#include <fmt/format.h>

#include "engine/core/error.hpp"
#include "engine/io/append_bytes.hpp"
#include "engine/io/laz_point10.hpp"
#include "engine/io/laz_point14.hpp"

namespace palpate {

namespace {

/// Number of layers: those of positions and returns, and one each for colours, infrared, wave packets and every extra
/// byte.
std::size_t layersOf(const LazLayout& layout) {
  return kLazLayers14 + (layout.colorAt ? 1 : 0) + (layout.infraredAt ? 1 : 0) + (layout.wavesAt ? 1 : 0) +
         layout.extraBytes;
}

}  // namespace

/// Decodes all rows but the first.
class LazChunkDecoder::Rows {
 public:
  virtual ~Rows() = default;
  virtual void read(std::byte* rows, std::size_t count) = 0;
  /// The same for this chunk and another one of its file.
  virtual void readBoth(std::byte* rows, Rows& other, std::byte* others, std::size_t count) = 0;
  virtual bool isWrong() const = 0;
  virtual std::size_t left() const = 0;
};

class LazChunkDecoder::Pointwise final : public Rows {
 public:
  Pointwise(const LazLayout& layout, std::span<const std::byte> bytes)
      : layout_(layout), decoder_(bytes.subspan(layout.rowBytes)), row_(layout, bytes.data()) {}

  void read(std::byte* rows, std::size_t count) override {
    RangeDecoder decoder = decoder_;  // a local copy, so that the compiler knows that rows do not alias it
    for (std::size_t k = 0; k < count; ++k) {
      LazRow10::Lane<RangeDecoder> lane{row_, decoder, rows + k * layout_.rowBytes};
      LazRow10::code(layout_, lane);
    }
    decoder_ = decoder;
  }
  void readBoth(std::byte* rows, Rows& other, std::byte* others, std::size_t count) override {
    auto& second = static_cast<Pointwise&>(other);
    const std::size_t done =
        kHasShifts ? readMostWithShifts(rows, second, others, count) : readMost(rows, second, others, count);
    read(rows + done * layout_.rowBytes, count - done);
    second.read(others + done * layout_.rowBytes, count - done);
  }
  bool isWrong() const override { return decoder_.isWrong(); }
  std::size_t left() const override { return decoder_.left(); }

 private:
  /// Reads rows until one of the chunks is near its end; returns their number.
  [[gnu::always_inline]] std::size_t readSideBySide(std::byte* rows, Pointwise& other, std::byte* others,
                                                    std::size_t count) {
    using Decoder = RangeDecoderOf<false>;
    Decoder first(decoder_), second(other.decoder_);
    const LazLayout layout = layout_;
    const std::size_t rowBytes = layout.rowBytes, most = Decoder::kMaxBytes * (row_.mostCalls() + 1);
    std::size_t done = 0;
    for (; done < count && first.left() >= most && second.left() >= most; ++done) {
      LazRow10::Lane<Decoder> a{row_, first, rows + done * rowBytes};
      LazRow10::Lane<Decoder> b{other.row_, second, others + done * rowBytes};
      LazRow10::code(layout, a, b);
    }
    decoder_ = RangeDecoder(first), other.decoder_ = RangeDecoder(second);
    return done;
  }
  std::size_t readMost(std::byte* rows, Pointwise& other, std::byte* others, std::size_t count) {
    return readSideBySide(rows, other, others, count);
  }
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  // Uses shift and count instructions with lower latency, available on processors since about 2013; Clang cannot enable
  // all of them.
  inline static const bool kHasShifts =
      __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("lzcnt");
  [[gnu::target("bmi,bmi2,lzcnt")]] std::size_t readMostWithShifts(std::byte* rows, Pointwise& other, std::byte* others,
                                                                   std::size_t count) {
    return readSideBySide(rows, other, others, count);
  }
#else
  static constexpr bool kHasShifts = false;
  std::size_t readMostWithShifts(std::byte* rows, Pointwise& other, std::byte* others, std::size_t count) {
    return readMost(rows, other, others, count);
  }
#endif

  LazLayout layout_;
  RangeDecoder decoder_;
  LazRow10 row_;
};

class LazChunkDecoder::Layered final : public Rows {
 public:
  /// `layers`: read from the file.
  Layered(const LazLayout& layout, std::span<const std::byte> first, std::vector<LazLayer<RangeDecoder>> layers)
      : rowBytes_(layout.rowBytes), layers_(std::move(layers)), row_(layout, layers_, first.data()) {}

  void read(std::byte* rows, std::size_t count) override {
    for (std::size_t k = 0; k < count; ++k) row_.code(rows + k * rowBytes_);
  }
  void readBoth(std::byte* rows, Rows& other, std::byte* others, std::size_t count) override {
    read(rows, count);
    other.read(others, count);
  }
  bool isWrong() const override {
    return std::ranges::any_of(layers_, [](const auto& layer) { return layer.changes && layer.coder.isWrong(); });
  }
  std::size_t left() const override {
    std::size_t left = 0;
    for (const auto& layer : layers_) left += layer.coder.left();
    return left;
  }

 private:
  std::size_t rowBytes_;
  std::vector<LazLayer<RangeDecoder>> layers_;
  LazRow14<RangeDecoder> row_;
};

namespace {

/// Reads the layers, which follow the first row, the number of points and the layers' lengths.
std::vector<LazLayer<RangeDecoder>> layersFrom(const std::filesystem::path& file, const LazLayout& layout,
                                               const LazChunk& chunk, std::span<const std::byte> bytes) {
  const std::size_t count = layersOf(layout), headAt = layout.rowBytes, sizesAt = headAt + 4;
  const auto refuse = [&](std::size_t at, const std::string& why) {
    return FileError::atByte(file, chunk.at + at, why);
  };
  std::size_t at = sizesAt + 4 * count;
  if (bytes.size() < at)
    throw refuse(bytes.size(),
                 fmt::format("a chunk of {} bytes, which are too few for its {} layers", bytes.size(), count));
  if (const auto points = loadScalar<std::uint32_t>(bytes.data() + headAt); points < chunk.points)
    throw refuse(headAt, fmt::format("a chunk of {} points, where the table has {}", points, chunk.points));
  std::vector<LazLayer<RangeDecoder>> layers;
  layers.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto length = loadScalar<std::uint32_t>(bytes.data() + sizesAt + 4 * k);
    if (length > bytes.size() - at)
      throw refuse(sizesAt + 4 * k, fmt::format("layer {} of {} has {} bytes, and {} are left of its chunk", k + 1,
                                                count, length, bytes.size() - at));
    layers.push_back({RangeDecoder(bytes.subspan(at, length)), length > 0});
    at += length;
  }
  return layers;
}

}  // namespace

LazChunkDecoder::LazChunkDecoder(const std::filesystem::path& file, const LazLayout& layout, const LazChunk& chunk,
                                 std::span<const std::byte> bytes)
    : file_(file), chunk_(chunk), rowBytes_(layout.rowBytes) {
  if (bytes.size() < rowBytes_)
    throw FileError::atByte(file, chunk.at + bytes.size(),
                            fmt::format("a chunk of {} bytes, where a point has {}", bytes.size(), rowBytes_));
  first_ = bytes.first(rowBytes_);
  if (layout.layered)
    rows_ = std::make_unique<Layered>(layout, first_, layersFrom(file, layout, chunk, bytes));
  else
    rows_ = std::make_unique<Pointwise>(layout, bytes);
}

LazChunkDecoder::~LazChunkDecoder() = default;

std::size_t LazChunkDecoder::readFirst(std::byte* rows, std::size_t count) {
  if (count == 0 || done_ > 0) return 0;
  std::copy(first_.begin(), first_.end(), rows);
  return 1;
}

void LazChunkDecoder::read(std::byte* rows, std::size_t count) {
  const std::size_t first = readFirst(rows, count);
  rows_->read(rows + first * rowBytes_, count - first);
  done_ += count;
  check();
}

void LazChunkDecoder::readBoth(LazChunkDecoder& a, std::byte* rowsOfA, LazChunkDecoder& b, std::byte* rowsOfB,
                               std::size_t count) {
  const std::size_t first = a.readFirst(rowsOfA, count), second = b.readFirst(rowsOfB, count);
  const std::size_t both = count - std::max(first, second);
  rowsOfA += first * a.rowBytes_, rowsOfB += second * b.rowBytes_;
  a.rows_->readBoth(rowsOfA, *b.rows_, rowsOfB, both);
  a.rows_->read(rowsOfA + both * a.rowBytes_, count - first - both);
  b.rows_->read(rowsOfB + both * b.rowBytes_, count - second - both);
  a.done_ += count, b.done_ += count;
  a.check();
  b.check();
}

void LazChunkDecoder::check() const {
  if (chunk_.points > 1 && rows_->isWrong())
    throw FileError::atByte(file_, chunk_.at + chunk_.bytes,
                            fmt::format("the chunk of {} points that begins at byte {} ends inside them, or is damaged",
                                        chunk_.points, chunk_.at));
}

std::size_t LazChunkDecoder::left() const { return rows_->left(); }

namespace {

std::vector<std::byte> encodePointwise(const LazLayout& layout, std::span<const std::byte> rows) {
  RangeEncoder encoder;
  LazRow10 row(layout, rows.data());
  std::vector<std::byte> next(layout.rowBytes);
  for (std::size_t at = layout.rowBytes; at < rows.size(); at += layout.rowBytes) {
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(at), next.size(), next.begin());
    LazRow10::Lane<RangeEncoder> lane{row, encoder, next.data()};
    LazRow10::code(layout, lane);
  }
  return encoder.finish();
}

std::vector<std::byte> encodeLayered(const LazLayout& layout, std::span<const std::byte> rows) {
  std::vector<LazLayer<RangeEncoder>> layers(layersOf(layout));
  for (const auto always : {LazLayer14::places, LazLayer14::heights})
    layers[static_cast<std::size_t>(always)].changes = true;
  LazRow14<RangeEncoder> row(layout, layers, rows.data());
  std::vector<std::byte> next(layout.rowBytes);
  for (std::size_t at = layout.rowBytes; at < rows.size(); at += layout.rowBytes) {
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(at), next.size(), next.begin());
    row.code(next.data());
  }
  std::vector<std::byte> bytes(4 + 4 * layers.size());  // number of rows, then of bytes in each layer
  const auto put = [&](std::size_t at, std::size_t number) {
    const auto small = static_cast<std::uint32_t>(number);
    std::memcpy(bytes.data() + at, &small, sizeof small);
  };
  put(0, rows.size() / layout.rowBytes);
  for (std::size_t k = 0; k < layers.size(); ++k) {
    if (!layers[k].changes) continue;
    const std::vector<std::byte> stream = layers[k].coder.finish();
    put(4 + 4 * k, stream.size());
    appendBytes(bytes, stream);
  }
  return bytes;
}

}  // namespace

std::vector<std::byte> encodeLazChunk(const LazLayout& layout, std::span<const std::byte> rows) {
  std::vector<std::byte> bytes(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(layout.rowBytes));
  appendBytes(bytes, layout.layered ? encodeLayered(layout, rows) : encodePointwise(layout, rows));
  return bytes;
}

}  // namespace palpate
