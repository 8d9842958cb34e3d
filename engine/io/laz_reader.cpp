#include "engine/io/laz_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "engine/core/parallel.hpp"
#include "engine/io/laz_chunk.hpp"

namespace palpate {

namespace {

constexpr std::size_t kBlock = 1024;  // rows that stay near the processor
constexpr std::uint64_t kTogether = std::uint64_t{1} << 23, kSlice = kTogether / 32;  // points
constexpr std::uint64_t kMostFromByte = 64;  // points that room is made for at once; more are rare

/// Unpacks the next `count` points of a chunk, which are from number `base` on.
void take(LazChunkDecoder& decoder, std::size_t rowBytes, std::size_t base, std::size_t count, LasColumns& columns) {
  BareVector<std::byte> rows(std::min(count, kBlock) * rowBytes);
  for (std::size_t done = 0; done < count;) {
    const std::size_t now = std::min(kBlock, count - done);
    decoder.read(rows.data(), now);
    columns.take(rows.data(), base + done, now);
    done += now;
  }
}

}  // namespace

void readLazPoints(const std::filesystem::path& file, const LazLayout& layout, std::span<const LazChunk> chunks,
                   std::span<const std::byte> body, std::uint64_t bodyAt, LasColumns& columns, Log* log) {
  std::uint64_t points = 0;
  for (const LazChunk& chunk : chunks) points += chunk.points;
  columns.reserve(std::min<std::uint64_t>(points, body.size() * kMostFromByte));
  std::atomic<std::size_t> odd = 0;
  const auto open = [&](const LazChunk& chunk) {
    return LazChunkDecoder(file, layout, chunk, body.subspan(chunk.at - bodyAt, chunk.bytes));
  };
  for (std::size_t begin = 0, end = 0; begin < chunks.size(); begin = end) {
    std::vector<std::size_t> bases;
    std::size_t to = columns.size();
    for (; end < chunks.size() && (end == begin || to + chunks[end].points <= columns.size() + kTogether); ++end) {
      bases.push_back(to);
      to += chunks[end].points;
    }
    if (end == begin + 1) {  // perhaps a very long one, which is unpacked slice by slice
      LazChunkDecoder decoder = open(chunks[begin]);
      for (std::size_t base = columns.size(); base < to; base = columns.size()) {
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kSlice, to - base));
        columns.grow(base + count);
        take(decoder, layout.rowBytes, base, count, columns);
      }
      odd += decoder.left() > 0 ? 1 : 0;
    } else {
      columns.grow(to);
      parallelBlocks(end - begin, 1, columns.threads(), [&](std::size_t k, std::size_t) {
        const LazChunk& chunk = chunks[begin + k];
        LazChunkDecoder decoder = open(chunk);
        take(decoder, layout.rowBytes, bases[k], chunk.points, columns);
        odd += decoder.left() > 0 ? 1 : 0;
      });
    }
    if (log) log->progress(file.filename().string(), static_cast<double>(to) / static_cast<double>(points));
  }
  if (odd > 0 && log && layout.chunked)
    log->say("{}: {} of {} chunks are longer than their points need: perhaps damaged", file.filename().string(),
             odd.load(), chunks.size());
}

}  // namespace palpate
