// The points of one chunk of a LAZ file.
#pragma once

#include <memory>

#include "engine/io/laz_layout.hpp"

namespace palpate {

/// Unpacks front to back. Chunks are independent of each other, and may be unpacked on as many threads.
class LazChunkDecoder {
 public:
  /// `bytes`: of the chunk, which outlive it. Throws FileError where they are too few to begin with, or their layers
  /// are not what they say.
  LazChunkDecoder(const std::filesystem::path& file, const LazLayout& layout, const LazChunk& chunk,
                  std::span<const std::byte> bytes);
  ~LazChunkDecoder();

  /// The next `count` rows. Throws FileError where there are none: the bytes have come to their end.
  void read(std::byte* rows, std::size_t count);
  /// The next `count` rows of each of two chunks of one file, which takes less time than one chunk after the other
  /// where points are coded in one stream. Layers keep a processor busy by themselves. Throws FileError as read().
  static void readBoth(LazChunkDecoder& a, std::byte* rowsOfA, LazChunkDecoder& b, std::byte* rowsOfB,
                       std::size_t count);
  /// Bytes that were not needed: none after the last point of a chunk as encoders make it.
  std::size_t left() const;

 private:
  class Rows;
  class Pointwise;
  class Layered;

  /// Of the rows that are read next, the first one of a chunk, if it is among them: how many.
  std::size_t readFirst(std::byte* rows, std::size_t count);
  /// Throws FileError where the bytes came to their end before the rows that were read.
  void check() const;

  const std::filesystem::path& file_;
  LazChunk chunk_;
  std::size_t rowBytes_;
  std::uint64_t done_ = 0;
  std::span<const std::byte> first_;  // the first row, as it is
  std::unique_ptr<Rows> rows_;
};

/// Packs rows of LAS, at least one.
std::vector<std::byte> encodeLazChunk(const LazLayout& layout, std::span<const std::byte> rows);

}  // namespace palpate
