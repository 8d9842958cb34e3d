#include "engine/io/laz_chunk.hpp"

#include <fmt/format.h>

#include "engine/core/error.hpp"
#include "engine/io/laz_point10.hpp"
#include "engine/io/laz_point14.hpp"

namespace palpate {

namespace {

/// Streams of a layered chunk: those of places, of colours, of infrared, of each byte that is no part of a format.
std::size_t layersOf(const LazLayout& layout) {
  return kLazLayers14 + (layout.colorAt ? 1 : 0) + (layout.infraredAt ? 1 : 0) + layout.extraBytes;
}

void append(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace

/// All rows but the first.
class LazChunkDecoder::Rows {
 public:
  virtual ~Rows() = default;
  virtual void read(std::byte* rows, std::size_t count) = 0;
  virtual bool isWrong() const = 0;
  virtual std::size_t left() const = 0;
};

class LazChunkDecoder::Pointwise final : public Rows {
 public:
  Pointwise(const LazLayout& layout, std::span<const std::byte> bytes)
      : rowBytes_(layout.rowBytes), decoder_(bytes.subspan(layout.rowBytes)), row_(layout, bytes.data()) {}

  void read(std::byte* rows, std::size_t count) override {
    RangeDecoder decoder = decoder_;  // of which the compiler knows that rows do not overlap it
    for (std::size_t k = 0; k < count; ++k) row_.code(decoder, rows + k * rowBytes_);
    decoder_ = decoder;
  }
  bool isWrong() const override { return decoder_.isWrong(); }
  std::size_t left() const override { return decoder_.left(); }

 private:
  std::size_t rowBytes_;
  RangeDecoder decoder_;
  LazRow10 row_;
};

class LazChunkDecoder::Layered final : public Rows {
 public:
  /// `layers`: from the file.
  Layered(const LazLayout& layout, std::span<const std::byte> first, std::vector<LazLayer<RangeDecoder>> layers)
      : rowBytes_(layout.rowBytes), layers_(std::move(layers)), row_(layout, layers_, first.data()) {}

  void read(std::byte* rows, std::size_t count) override {
    for (std::size_t k = 0; k < count; ++k) row_.code(rows + k * rowBytes_);
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

/// The streams that stand behind the first row, the number of points and the streams' lengths.
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

void LazChunkDecoder::read(std::byte* rows, std::size_t count) {
  if (count > 0 && done_ == 0) {
    std::copy(first_.begin(), first_.end(), rows);
    rows_->read(rows + rowBytes_, count - 1);
  } else {
    rows_->read(rows, count);
  }
  done_ += count;
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
    row.code(encoder, next.data());
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
  std::vector<std::byte> bytes(4 + 4 * layers.size());  // how many rows there are, and bytes in each layer
  const auto put = [&](std::size_t at, std::size_t number) {
    const auto small = static_cast<std::uint32_t>(number);
    std::memcpy(bytes.data() + at, &small, sizeof small);
  };
  put(0, rows.size() / layout.rowBytes);
  for (std::size_t k = 0; k < layers.size(); ++k) {
    if (!layers[k].changes) continue;
    const std::vector<std::byte> stream = layers[k].coder.finish();
    put(4 + 4 * k, stream.size());
    append(bytes, stream);
  }
  return bytes;
}

}  // namespace

std::vector<std::byte> encodeLazChunk(const LazLayout& layout, std::span<const std::byte> rows) {
  std::vector<std::byte> bytes(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(layout.rowBytes));
  append(bytes, layout.layered ? encodeLayered(layout, rows) : encodePointwise(layout, rows));
  return bytes;
}

}  // namespace palpate
