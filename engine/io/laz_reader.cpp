#include "engine/io/laz_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/laz_chunk.hpp"

namespace palpate {

namespace {

constexpr std::size_t kRowBlock = 1024;  // rows that stay in the cache
constexpr std::uint64_t kTogether = std::uint64_t{1} << 25, kSlice = std::uint64_t{1} << 18;  // points
constexpr std::uint64_t kMaxFromByte = 64;  // plausible number of points per byte; more are rare

/// Decodes the next `count` points of a chunk, whose numbers start at `base`.
void take(LazChunkDecoder& decoder, std::size_t rowBytes, std::size_t base, std::size_t count, LasColumns& columns) {
  BareVector<std::byte> rows(std::min(count, kRowBlock) * rowBytes);
  for (std::size_t done = 0; done < count;) {
    const std::size_t now = std::min(kRowBlock, count - done);
    decoder.read(rows.data(), now);
    columns.take(rows.data(), base + done, now);
    done += now;
  }
}

/// Like take() for all points of two chunks of the same file, interleaved.
void takeBoth(LazChunkDecoder& a, LazChunkDecoder& b, std::size_t rowBytes, std::array<std::size_t, 2> bases,
              std::array<std::size_t, 2> counts, LasColumns& columns) {
  const std::size_t both = std::min(counts[0], counts[1]);
  BareVector<std::byte> rows(2 * std::min(both, kRowBlock) * rowBytes);
  std::byte* const rowsOfB = rows.data() + rows.size() / 2;
  for (std::size_t done = 0; done < both;) {
    const std::size_t now = std::min(kRowBlock, both - done);
    LazChunkDecoder::readBoth(a, rows.data(), b, rowsOfB, now);
    columns.take(rows.data(), bases[0] + done, now);
    columns.take(rowsOfB, bases[1] + done, now);
    done += now;
  }
  take(a, rowBytes, bases[0] + both, counts[0] - both, columns);
  take(b, rowBytes, bases[1] + both, counts[1] - both, columns);
}

/// Chunks that are decoded concurrently; a chunk with an implausible number of points is a group of its own.
struct ChunkGroup {
  std::size_t begin, end;  // chunk indices
  std::uint64_t base, to;  // point numbers
  bool alone;
};

std::vector<ChunkGroup> groupsOf(std::span<const LazChunk> chunks) {
  const auto isUnlikely = [](const LazChunk& chunk) {
    return chunk.points > kTogether || chunk.points > chunk.bytes * kMaxFromByte;
  };
  std::vector<ChunkGroup> groups;
  std::uint64_t base = 0;
  for (std::size_t k = 0; k < chunks.size(); ++k) {
    const std::uint64_t points = chunks[k].points;
    const bool alone = isUnlikely(chunks[k]);
    if (groups.empty() || alone || groups.back().alone || groups.back().to + points > groups.back().base + kTogether)
      groups.push_back({k, k, base, base, alone});
    groups.back().end = k + 1;
    groups.back().to = base += points;
  }
  return groups;
}

}  // namespace

void readLazPoints(const std::filesystem::path& file, const LazLayout& layout, std::span<const LazChunk> chunks,
                   std::span<const std::byte> body, std::uint64_t bodyAt, LasColumns& columns, Log* log) {
  const std::vector<ChunkGroup> groups = groupsOf(chunks);
  const std::uint64_t points = groups.empty() ? 0 : groups.back().to;
  columns.reserve(std::min<std::uint64_t>(points, body.size() * kMaxFromByte));
  std::atomic<std::size_t> odd = 0;
  const auto open = [&](const LazChunk& chunk) {
    return LazChunkDecoder(file, layout, chunk, body.subspan(chunk.at - bodyAt, chunk.bytes));
  };
  for (const ChunkGroup& group : groups) {
    if (group.alone) {  // perhaps a very long one, which is decoded in slices
      LazChunkDecoder decoder = open(chunks[group.begin]);
      for (std::uint64_t base = group.base; base < group.to;) {
        const std::uint64_t count = std::min(kSlice, group.to - base);
        columns.makeRoom(base + count);
        take(decoder, layout.rowBytes, base, count, columns);
        base += count;
      }
      odd += decoder.left() > 0 ? 1 : 0;
    } else {
      std::vector<std::uint64_t> bases;
      for (std::uint64_t base = group.base;
           const LazChunk& chunk : chunks.subspan(group.begin, group.end - group.begin))
        bases.push_back(std::exchange(base, base + chunk.points));
      columns.makeRoom(group.to);
      const auto chunkAt = [&](std::size_t k) -> const LazChunk& { return chunks[group.begin + k]; };
      const auto unpack = [&](std::size_t k) {
        LazChunkDecoder decoder = open(chunkAt(k));
        take(decoder, layout.rowBytes, bases[k], chunkAt(k).points, columns);
        odd += decoder.left() > 0 ? 1 : 0;
      };
      const auto unpackBoth = [&](std::size_t k) {
        LazChunkDecoder first = open(chunkAt(k)), second = open(chunkAt(k + 1));
        takeBoth(first, second, layout.rowBytes, {bases[k], bases[k + 1]}, {chunkAt(k).points, chunkAt(k + 1).points},
                 columns);
        odd += (first.left() > 0 ? 1 : 0) + (second.left() > 0 ? 1 : 0);
      };
      // Two interleaved where that is faster, unless threads would be idle.
      const bool sideBySide = !layout.layered && bases.size() > threadCount(columns.threads());
      const std::size_t together = sideBySide ? 2 : 1;
      parallelBlocks(bases.size(), together, columns.threads(), [&](std::size_t begin, std::size_t end) {
        if (end - begin == 1) return unpack(begin);
        try {
          unpackBoth(begin);
        } catch (const FileError&) {  // repeat separately, so that the first damaged chunk is reported
          unpack(begin);
          unpack(begin + 1);
        }
      });
    }
    if (log) log->progress(file.filename().string(), static_cast<double>(group.to) / static_cast<double>(points));
  }
  if (odd > 0 && log && layout.chunked)
    log->warn("{}: {} of {} chunks are longer than their points need: perhaps damaged", file.filename().string(),
              odd.load(), chunks.size());
}

}  // namespace palpate
