// Compression parameters of a LAZ file: LASzip's record before the points, and the chunk table (Isenburg 2013;
// specification of LAZ by rapidlasso, 2021).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "engine/io/las_layout.hpp"

namespace palpate {

inline constexpr std::string_view kLazUser = "laszip encoded";
inline constexpr unsigned kLazRecord = 22204;
/// Set in the header's point format byte if the points are compressed.
inline constexpr unsigned kLazBit = 0x80;

inline constexpr std::size_t kLazWaveBytes = 29;  // size of a point's wave packet

/// Contents of the record. Points of formats 0 to 5 are coded in one stream; those of formats 6 to 10 in layers, a
/// stream for each group of values that change together.
struct LazLayout {
  bool chunked = true, layered = false;
  /// Points of each chunk but the last; nothing: the table contains the number for each chunk.
  std::optional<std::uint64_t> chunkPoints;
  /// In version 3, which most programs write, the other items attribute most points to scanner channel 0, and some to
  /// the previous channel; version 4 has corrected this.
  bool channelsLag = true;
  /// Offsets in a row; 0: absent.
  std::size_t timeAt = 0, colorAt = 0, infraredAt = 0, wavesAt = 0, bytesAt = 0;
  std::size_t extraBytes = 0, rowBytes = 0;
};

/// `header`: with the format of uncompressed points. Throws FileError with the byte of the error, and for versions
/// before 2010.
LazLayout readLazLayout(const std::filesystem::path& file, const LasHeader& header, const LasRecord& record);
/// Layout of files that are written: chunks of 50,000 points. `format`: without wave packets.
LazLayout lazLayoutFor(unsigned format, std::size_t rowBytes);
/// The record with its header.
std::vector<std::byte> lazRecordFor(unsigned format, const LazLayout& layout);

/// A group of points that is compressed independently.
struct LazChunk {
  std::uint64_t at = 0, bytes = 0;  ///< position in the file
  std::uint64_t points = 0;
};

/// The chunks of a file, and the start of the data that follows them (behind the table if it follows the chunks).
struct LazChunks {
  std::vector<LazChunk> chunks;
  std::uint64_t end = 0;
};
/// `body`: the bytes of the file starting at its points. Throws FileError with the byte of an error in the table.
LazChunks readLazChunks(const std::filesystem::path& file, const LasHeader& header, const LazLayout& layout,
                        std::span<const std::byte> body);
/// The table for chunks of a layout from lazLayoutFor().
std::vector<std::byte> lazChunkTable(std::span<const LazChunk> chunks);

}  // namespace palpate
