#include "engine/io/laz_layout.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.hpp"
#include "engine/io/integer_model.hpp"

namespace palpate {

namespace {

constexpr std::size_t kFixedBytes = 34, kItemBytes = 6;  // in the record
constexpr std::uint32_t kAnyNumber = 0xffffffffu;        // number of points per chunk varies
constexpr std::uint64_t kUsualChunk = 50'000;

enum class Packing : unsigned { none, pointwise, chunked, layered };

// Item numbers in the record.
enum class Item : unsigned {
  bytes = 0,
  point10 = 6,
  time11 = 7,
  color12 = 8,
  waves13 = 9,
  point14 = 10,
  color14 = 11,
  colorInfrared14 = 12,
  waves14 = 13,
  bytes14 = 14
};
struct ItemSpan {
  Item item;
  std::size_t bytes;
};

/// Items of a point format.
std::vector<ItemSpan> itemsOf(unsigned format, std::size_t rowBytes) {
  const LasPointFormat points = lasPointFormat(format);
  std::vector<ItemSpan> items;
  if (format < 6) {
    items.push_back({Item::point10, 20});
    if (points.hasTime) items.push_back({Item::time11, 8});
    if (points.colorAt) items.push_back({Item::color12, 6});
  } else {
    items.push_back({Item::point14, 30});
    if (points.hasInfrared)
      items.push_back({Item::colorInfrared14, 8});
    else if (points.colorAt)
      items.push_back({Item::color14, 6});
  }
  if (points.hasWaves) items.push_back({format < 6 ? Item::waves13 : Item::waves14, kLazWaveBytes});
  if (rowBytes > points.bytes) items.push_back({format < 6 ? Item::bytes : Item::bytes14, rowBytes - points.bytes});
  return items;
}

/// Offsets in rows of a format, independent of compression.
LazLayout placesOf(unsigned format, std::size_t rowBytes) {
  const LasPointFormat points = lasPointFormat(format);
  LazLayout layout{.layered = format >= 6, .rowBytes = rowBytes};
  if (points.hasTime) layout.timeAt = format < 6 ? 20 : 22;
  layout.colorAt = points.colorAt;
  if (points.hasInfrared) layout.infraredAt = points.colorAt + 6;
  if (points.hasWaves) layout.wavesAt = points.bytes - kLazWaveBytes;
  layout.bytesAt = points.bytes;
  layout.extraBytes = rowBytes - points.bytes;
  return layout;
}

/// Verifies that the record's items are those of the format, in a supported version.
void readItems(const std::filesystem::path& file, const LasHeader& header, const LasRecord& record, LazLayout& layout) {
  const std::uint64_t dataAt = record.at + record.head.size();
  const std::vector<ItemSpan> items = itemsOf(header.format, header.pointBytes);
  const auto count = loadScalar<std::uint16_t>(record.data, 32);
  if (count != items.size() || record.data.size() < kFixedBytes + count * kItemBytes)
    throw FileError::atByte(file, dataAt + 32,
                            fmt::format("points are packed as {} items; those of format {} with {} bytes have {}",
                                        count, header.format, header.pointBytes, items.size()));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = kFixedBytes + k * kItemBytes;
    const auto item = loadScalar<std::uint16_t>(record.data, at),
               bytes = loadScalar<std::uint16_t>(record.data, at + 2),
               version = loadScalar<std::uint16_t>(record.data, at + 4);
    const auto refuse = [&](const std::string& why) { return FileError::atByte(file, dataAt + at, why); };
    if (item != static_cast<unsigned>(items[k].item) || bytes != items[k].bytes)
      throw refuse(
          fmt::format("item {} is of kind {} and {} bytes; points of format {} have one of kind {} and {} bytes", k + 1,
                      item, bytes, header.format, static_cast<unsigned>(items[k].item), items[k].bytes));
    // Wave packets in one stream have only one version.
    const unsigned lowest = layout.layered ? 3 : items[k].item == Item::waves13 ? 1 : 2;
    if (version < lowest)
      throw refuse(fmt::format(
          "item {} is of version {}, as programs wrote it before 2010; unpack the file to LAS first", k + 1, version));
    if (version > (layout.layered ? 4 : 2)) throw refuse(fmt::format("item {} is of version {}", k + 1, version));
    if (layout.layered) layout.channelsLag = version == 3;
  }
}

/// Offset of the chunk table, relative to the first point.
std::size_t tablePlace(const std::filesystem::path& file, std::uint64_t bodyAt, std::span<const std::byte> body) {
  constexpr std::int64_t kAtTheEnd = -1;  // for a file that was written sequentially
  if (body.size() < 8)
    throw FileError::atByte(file, bodyAt + body.size(), "the file ends before the position of its table of chunks");
  std::size_t saidAt = 0;
  auto place = loadScalar<std::int64_t>(body, 0);
  if (place == kAtTheEnd && body.size() >= 16) {
    saidAt = body.size() - 8;
    place = loadScalar<std::int64_t>(body, saidAt);
  }
  const auto first = static_cast<std::int64_t>(bodyAt) + 8;
  const auto last = static_cast<std::int64_t>(bodyAt + body.size()) - 8;
  const bool isPlace = place >= first && place <= last;
  if (!isPlace && saidAt > 0)
    throw FileError::atByte(file, bodyAt + saidAt,
                            "the file does not end with the position of its table of chunks; it is truncated");
  if (!isPlace && place > last)
    throw FileError::atByte(file, bodyAt + body.size(),
                            fmt::format("the file ends before its table of chunks, which is said to be at byte {}; it "
                                        "is truncated, or its header is wrong",
                                        place));
  if (!isPlace)
    throw FileError::atByte(
        file, bodyAt + saidAt,
        fmt::format("the table of chunks is at byte {}; expected one from {} to {}", place, first, last));
  return static_cast<std::size_t>(place) - bodyAt;
}

}  // namespace

LazLayout readLazLayout(const std::filesystem::path& file, const LasHeader& header, const LasRecord& record) {
  const std::uint64_t dataAt = record.at + record.head.size();
  if (record.data.size() < kFixedBytes)
    throw FileError::atByte(
        file, record.at,
        fmt::format("the record of LASzip has {} bytes; expected {} at least", record.data.size(), kFixedBytes));
  LazLayout layout = placesOf(header.format, header.pointBytes);
  const auto packing = loadScalar<std::uint16_t>(record.data, 0), coder = loadScalar<std::uint16_t>(record.data, 2);
  const auto wanted = layout.layered ? packing == static_cast<unsigned>(Packing::layered)
                                     : packing == static_cast<unsigned>(Packing::pointwise) ||
                                           packing == static_cast<unsigned>(Packing::chunked);
  if (!wanted)
    throw FileError::atByte(file, dataAt,
                            fmt::format("compressor {} does not apply to point format {}", packing, header.format));
  if (coder != 0) throw FileError::atByte(file, dataAt + 2, fmt::format("coder {}; expected 0", coder));
  layout.chunked = packing != static_cast<unsigned>(Packing::pointwise);
  const auto chunkPoints = loadScalar<std::uint32_t>(record.data, 12);
  if (layout.chunked && chunkPoints == 0) throw FileError::atByte(file, dataAt + 12, "chunks of no points");
  if (chunkPoints != kAnyNumber) layout.chunkPoints = chunkPoints;
  readItems(file, header, record, layout);
  return layout;
}

LazLayout lazLayoutFor(unsigned format, std::size_t rowBytes) {
  LazLayout layout = placesOf(format, rowBytes);
  layout.chunkPoints = kUsualChunk;
  return layout;
}

std::vector<std::byte> lazRecordFor(unsigned format, const LazLayout& layout) {
  const std::vector<ItemSpan> items = itemsOf(format, layout.rowBytes);
  const std::size_t dataBytes = kFixedBytes + items.size() * kItemBytes;
  std::vector<std::byte> bytes(kLasRecordHead + dataBytes);
  const auto put = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  std::memcpy(bytes.data() + 2, kLazUser.data(), kLazUser.size());
  put(18, static_cast<std::uint16_t>(kLazRecord));
  put(20, static_cast<std::uint16_t>(dataBytes));
  constexpr std::string_view kDescription = "by LASzip's method";
  std::memcpy(bytes.data() + 22, kDescription.data(), kDescription.size());
  const std::size_t data = kLasRecordHead;
  put(data, static_cast<std::uint16_t>(layout.layered ? Packing::layered : Packing::chunked));
  put(data + 4, std::uint8_t{3});  // version of LASzip with this file format
  put(data + 5, std::uint8_t{4});
  put(data + 6, std::uint16_t{3});
  put(data + 12, static_cast<std::uint32_t>(*layout.chunkPoints));
  put(data + 16, std::int64_t{-1});  // no special records behind the points
  put(data + 24, std::int64_t{-1});
  put(data + 32, static_cast<std::uint16_t>(items.size()));
  for (std::size_t k = 0; k < items.size(); ++k) {
    const std::size_t at = data + kFixedBytes + k * kItemBytes;
    put(at, static_cast<std::uint16_t>(items[k].item));
    put(at + 2, static_cast<std::uint16_t>(items[k].bytes));
    put(at + 4, static_cast<std::uint16_t>(layout.layered ? 3 : 2));
  }
  return bytes;
}

LazChunks readLazChunks(const std::filesystem::path& file, const LasHeader& header, const LazLayout& layout,
                        std::span<const std::byte> body) {
  const std::uint64_t bodyAt = header.pointsAt;
  if (header.points == 0 && body.size() < 8) return {{}, bodyAt};  // written by some programs for a file without points
  if (!layout.chunked) {
    const std::uint64_t end = header.longRecordsAt ? header.longRecordsAt : bodyAt + body.size();
    if (header.points == 0) return {{}, end};
    return {{{bodyAt, body.size(), header.points}}, end};
  }
  const std::size_t table = tablePlace(file, bodyAt, body);
  const auto refuse = [&](const std::string& why) { return FileError::atByte(file, bodyAt + table, why); };
  if (const auto version = loadScalar<std::uint32_t>(body, table); version != 0)
    throw refuse(fmt::format("a table of chunks of version {}; expected 0", version));
  const auto count = loadScalar<std::uint32_t>(body, table + 4);
  if (count > body.size())
    throw refuse(fmt::format("a table of {} chunks, which {} bytes cannot hold", count, body.size()));
  const auto packed = body.subspan(table + 8);
  RangeDecoder decoder(packed);
  IntegerModel model(32, 2);
  LazChunks found;
  std::uint64_t at = bodyAt + 8, left = header.points;
  std::int32_t points = 0, bytes = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (!layout.chunkPoints) points = model.code(decoder, points, 0, 0);
    bytes = model.code(decoder, bytes, 0, 1);
    const std::uint64_t length = static_cast<std::uint32_t>(bytes);
    const std::uint64_t holds =
        layout.chunkPoints ? std::min(left, *layout.chunkPoints) : std::uint64_t{static_cast<std::uint32_t>(points)};
    if (decoder.isWrong()) throw refuse(fmt::format("the table of {} chunks is damaged at chunk {}", count, k + 1));
    if (length > bodyAt + table - at)
      throw refuse(fmt::format("chunk {} of {} would reach from byte {} to byte {}, past the table", k + 1, count, at,
                               at + length));
    if (holds > left || (holds > 0 && length == 0))
      throw refuse(fmt::format("chunk {} of {} claims {} points in {} bytes; {} of {} are left", k + 1, count, holds,
                               length, left, header.points));
    if (holds > 0) found.chunks.push_back({at, length, holds});
    at += length;
    left -= holds;
  }
  if (left > 0)
    throw refuse(
        fmt::format("the table has {} chunks, and {} of {} points are in none of them", count, left, header.points));
  const bool atEnd = loadScalar<std::int64_t>(body, 0) == -1;
  found.end = bodyAt + body.size() - (atEnd ? 0 : count == 0 ? packed.size() : decoder.left());
  return found;
}

std::vector<std::byte> lazChunkTable(std::span<const LazChunk> chunks) {
  std::vector<std::byte> table(8);
  const auto count = static_cast<std::uint32_t>(chunks.size());
  std::memcpy(table.data() + 4, &count, sizeof count);
  if (chunks.empty()) return table;
  RangeEncoder encoder;
  IntegerModel model(32, 2);
  std::int32_t before = 0;
  for (const LazChunk& chunk : chunks) {
    const auto bytes = static_cast<std::int32_t>(chunk.bytes);
    model.code(encoder, before, bytes, 1);
    before = bytes;
  }
  const std::vector<std::byte> packed = encoder.finish();
  table.insert(table.end(), packed.begin(), packed.end());
  return table;
}

}  // namespace palpate
