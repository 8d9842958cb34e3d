// LAS 1.0 to 1.4 (ASPRS 2003 to 2019): what the header, its records and each point hold, and where.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/point_cloud.hpp"

namespace palpate {

inline constexpr std::size_t kLasShortHeader = 227, kLasHeader13 = 235, kLasHeader14 = 375;  ///< bytes
inline constexpr std::size_t kLasRecordHead = 54,
                             kLasLongRecordHead = 60;  ///< of a record before and behind the points
inline constexpr std::size_t kLasDescriptor = 192;     ///< bytes that describe an extra one
inline constexpr unsigned kLasFormats = 11;

struct LasHeader {
  unsigned minor = 2;  ///< version 1.minor
  std::size_t size = kLasShortHeader;
  std::uint32_t pointsAt = kLasShortHeader;  ///< bytes before the first point
  std::uint32_t records = 0;
  unsigned format = 0;
  bool packed = false;  ///< the points are compressed (LAZ)
  std::size_t pointBytes = 20;
  std::uint64_t points = 0;
  CoordinateGrid grid;
  std::uint64_t longRecordsAt = 0;  ///< 0: none; with the number of them only in 1.4
  std::uint32_t longRecords = 0;
  std::uint64_t waveformsAt = 0;  ///< 0: none, from 1.3 on
};

/// From the first bytes of a file, of which there may be fewer than a header has. Throws FileError with the byte where
/// the header lies or is none.
LasHeader readLasHeader(const std::filesystem::path& file, std::span<const std::byte> begin);

/// A record before the points, or behind them.
struct LasRecord {
  std::string user;
  unsigned id = 0;
  std::uint64_t at = 0;  ///< of its head, from where the bytes begin
  std::span<const std::byte> head, data;

  bool is(std::string_view ofUser, unsigned ofId) const { return user == ofUser && id == ofId; }
};
/// `head`: the bytes of the file before its points. Throws FileError with the byte where a record ends too late.
std::vector<LasRecord> lasRecords(const std::filesystem::path& file, const LasHeader& header,
                                  std::span<const std::byte> head);
/// `tail`: those behind its points, which begin at `tailAt` of the file.
std::vector<LasRecord> lasLongRecords(const std::filesystem::path& file, const LasHeader& header,
                                      std::span<const std::byte> tail, std::uint64_t tailAt);

/// One number of each point. LAS has whole numbers of 64 bits, which are carried as double precision.
struct LasField {
  std::string name;
  std::size_t at = 0;  ///< bytes from the beginning of the point
  ScalarType type = ScalarType::u8;
  bool wide = false, isSigned = false;  ///< 64 bits; `type` is f64 then
  unsigned shift = 0, bits = 0;         ///< of a byte that several share; 0: all of it
  double scale = 1, offset = 0;         ///< of an extra one that has them: `type` is f64 then, `raw` what is stored
  std::optional<ScalarType> raw = {};

  std::size_t storedBytes() const { return wide ? 8 : sizeOf(raw.value_or(type)); }
};

/// What a format of points has besides places, in its order: colours by byte only.
struct LasPointFormat {
  std::size_t bytes = 20;
  std::vector<LasField> fields;
  std::size_t colorAt = 0;  ///< 0: none
  bool hasTime = false, hasInfrared = false, hasWaves = false;
};
/// `format`: below kLasFormats.
LasPointFormat lasPointFormat(unsigned format);
/// The smallest format that has so much; from 6 on where `extended`.
unsigned lasFormatWith(bool extended, bool time, bool color, bool infrared, bool waves);

/// Of the extra bytes as their record describes them, an array by its elements: NAME_0, NAME_1. Bytes that nothing
/// describes are `extra_byte_0` and so on. Names are words that no other number of a point has: letters that a word
/// cannot have become `_`, and the second of a name is NAME_2. `descriptor` says which of the record each is of, or is
/// past them.
struct LasExtraField {
  LasField field;
  std::size_t descriptor = 0;
};
/// `pointBytes`: of points of the format, with the extra ones. Nothing where the descriptors are of more.
std::optional<std::vector<LasExtraField>> lasExtraFields(std::span<const std::byte> descriptors,
                                                         const LasPointFormat& format, std::size_t pointBytes);

/// What LAS to LAS carries.
struct LasBaggage final : FormatBaggage {
  std::vector<std::byte> head, tail;  ///< the file's bytes before its points and behind them
  std::vector<std::byte> descriptors;
  LengthUnit unit = LengthUnit::unknown;  ///< as its coordinate system says
  unsigned colorStep = 257;               ///< what one step of 8 bits is in the file's 16: 1, 256 or 257
};

/// Of the record that keeps comments, which is palpate's own.
inline constexpr std::string_view kLasOurs = "palpate";
inline constexpr unsigned kLasComments = 1;
inline constexpr std::string_view kLasSpec = "LASF_Spec";
inline constexpr unsigned kLasExtraBytes = 4;
/// Extra bytes that are normals.
inline constexpr std::array<std::string_view, 3> kLasNormals{"NormalX", "NormalY", "NormalZ"};
/// Under which colours are carried that 8 bits cannot hold.
inline constexpr std::array<std::string_view, 3> kLasFineColors{"red16", "green16", "blue16"};

}  // namespace palpate
