// Codec for the points of one chunk of a LAZ file.
#pragma once

#include <memory>

#include "engine/io/laz_layout.hpp"

namespace palpate {

/// Decodes front to back. Chunks are independent, and may be decoded on several threads.
class LazChunkDecoder {
 public:
  /// `bytes`: of the chunk; must outlive the object. Throws FileError if they are too few, or if the layers are
  /// invalid.
  LazChunkDecoder(const std::filesystem::path& file, const LazLayout& layout, const LazChunk& chunk,
                  std::span<const std::byte> bytes);
  ~LazChunkDecoder();

  /// Reads the next `count` rows. Throws FileError if the data ends early.
  void read(std::byte* rows, std::size_t count);
  /// Reads the next `count` rows of two chunks of one file, interleaved. Faster than one after the other for points
  /// coded in one stream; layers already keep the processor busy. Throws FileError like read().
  static void readBoth(LazChunkDecoder& a, std::byte* rowsOfA, LazChunkDecoder& b, std::byte* rowsOfB,
                       std::size_t count);
  /// Number of unused bytes: 0 after the last point of an undamaged chunk.
  std::size_t left() const;

 private:
  class Rows;
  class Pointwise;
  class Layered;

  /// Copies the first row of the chunk if it is the next one and `count` > 0; returns the number of rows copied.
  std::size_t readFirst(std::byte* rows, std::size_t count);
  /// Throws FileError if the data ended before the rows that were read.
  void check() const;

  const std::filesystem::path& file_;
  LazChunk chunk_;
  std::size_t rowBytes_;
  std::uint64_t done_ = 0;
  std::span<const std::byte> first_;  // the first row, uncompressed
  std::unique_ptr<Rows> rows_;
};

/// Encodes one or more rows of LAS.
std::vector<std::byte> encodeLazChunk(const LazLayout& layout, std::span<const std::byte> rows);

}  // namespace palpate
