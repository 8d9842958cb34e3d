// How the points of a LAZ file are packed: the record of LASzip among those before the points, and the table of chunks
// (Isenburg 2013; the specification of LAZ that rapidlasso published in 2021).
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
/// Is set in the byte of a header that says the format of the points where they are packed.
inline constexpr unsigned kLazBit = 0x80;

inline constexpr std::size_t kLazWaveBytes = 29;  // of a point's wave packet

/// What the record says. Points of formats 0 to 5 are coded in one stream, pointwise; those of 6 to 10 in layers, a
/// stream for what changes together.
struct LazLayout {
  bool chunked = true, layered = false;
  /// Points of a chunk but the last one; nothing where the table says how many each has.
  std::optional<std::uint64_t> chunkPoints;
  /// Items that take most points for those of the scanner's channel 0, and some for those of the channel before
  /// (version 3, which most programs write; version 4 has mended that).
  bool channelsLag = true;
  /// Where in a row what is; 0: nowhere.
  std::size_t timeAt = 0, colorAt = 0, infraredAt = 0, wavesAt = 0, bytesAt = 0;
  std::size_t extraBytes = 0, rowBytes = 0;
};

/// `header`: with the format that the points have once they are unpacked. Throws FileError with the byte of what is
/// wrong, or is not read: what programs wrote before 2010.
LazLayout readLazLayout(const std::filesystem::path& file, const LasHeader& header, const LasRecord& record);
/// As files are written: chunks of 50,000 points. `format`: without wave packets.
LazLayout lazLayoutFor(unsigned format, std::size_t rowBytes);
/// Its record, with the head.
std::vector<std::byte> lazRecordFor(unsigned format, const LazLayout& layout);

/// Points that are packed by themselves.
struct LazChunk {
  std::uint64_t at = 0, bytes = 0;  ///< of the file
  std::uint64_t points = 0;
};

/// The chunks of a file, and where what follows them begins: behind the table, if that is where it stands.
struct LazChunks {
  std::vector<LazChunk> chunks;
  std::uint64_t end = 0;
};
/// `body`: the bytes of the file from its points on. Throws FileError with the byte where the table lies.
LazChunks readLazChunks(const std::filesystem::path& file, const LasHeader& header, const LazLayout& layout,
                        std::span<const std::byte> body);
/// The table for chunks as lazLayoutFor() has them.
std::vector<std::byte> lazChunkTable(std::span<const LazChunk> chunks);

}  // namespace palpate
