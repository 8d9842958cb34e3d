// LAS 1.0 to 1.4 (ASPRS 2003 to 2019): layout of the header, its records and points.
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
                             kLasLongRecordHead = 60;  ///< header size of a record before and behind the points
inline constexpr std::size_t kLasDescriptor = 192;     ///< size of the description of an extra attribute
inline constexpr unsigned kLasFormats = 11;

struct LasHeader {
  unsigned minor = 2;  ///< version 1.minor
  std::size_t size = kLasShortHeader;
  std::uint32_t pointsAt = kLasShortHeader;  ///< offset of the first point
  std::uint32_t records = 0;
  unsigned format = 0;
  bool packed = false;  ///< the points are compressed (LAZ)
  std::size_t pointBytes = 20;
  std::uint64_t points = 0;
  CoordinateGrid grid;
  std::uint64_t longRecordsAt = 0;  ///< 0: none; longRecords is set only in 1.4
  std::uint32_t longRecords = 0;
  std::uint64_t waveformsAt = 0;  ///< 0: none; since 1.3
};

/// From the first bytes of a file, which may be fewer than a header. Throws FileError with the byte where the header is
/// invalid.
LasHeader readLasHeader(const std::filesystem::path& file, std::span<const std::byte> begin);

/// A record before the points, or behind them.
struct LasRecord {
  std::string user;
  unsigned id = 0;
  std::uint64_t at = 0;  ///< offset of its header, relative to the given bytes
  std::span<const std::byte> head, data;

  bool is(std::string_view ofUser, unsigned ofId) const { return user == ofUser && id == ofId; }
};
/// `head`: the bytes of the file before its points. Throws FileError with the byte of a record that is too long.
std::vector<LasRecord> lasRecords(const std::filesystem::path& file, const LasHeader& header,
                                  std::span<const std::byte> head);
/// `tail`: the bytes behind the points, which start at byte `tailAt` of the file.
std::vector<LasRecord> lasLongRecords(const std::filesystem::path& file, const LasHeader& header,
                                      std::span<const std::byte> tail, std::uint64_t tailAt);

/// One value of each point.
struct LasField {
  std::string name;
  std::size_t at = 0;  ///< bytes from the beginning of the point
  ScalarType type = ScalarType::u8;
  unsigned shift = 0, bits = 0;  ///< bit field of a shared byte; bits 0: the whole byte
  double scale = 1, offset = 0;  ///< of an extra attribute with scaling: `type` f64, `raw` the stored type
  std::optional<ScalarType> raw = {};
  std::optional<double> noData = {};  ///< stored number of a missing value, which is read as NaN; only with scaling

  std::size_t storedBytes() const { return sizeOf(raw.value_or(type)); }
};

/// The values of a point format besides positions, in its order; of colours only the offset.
struct LasPointFormat {
  std::size_t bytes = 20;
  std::vector<LasField> fields;
  std::size_t colorAt = 0;  ///< 0: none
  bool hasTime = false, hasInfrared = false, hasWaves = false;
};
/// `format`: below kLasFormats.
LasPointFormat lasPointFormat(unsigned format);
/// The smallest format with these values; 6 or above if `extended`.
unsigned lasFormatWith(bool extended, bool time, bool color, bool infrared, bool waves);

/// Extra attributes as described by their record; an array becomes its elements NAME_0, NAME_1. Bytes without a
/// description are `extra_byte_0` and so on. Names are unique words: invalid characters become `_`, and a duplicate
/// becomes NAME_2. `descriptor`: index of the description, or beyond the last one.
struct LasExtraField {
  LasField field;
  std::size_t descriptor = 0;
};
/// `pointBytes`: size of a point with its extra attributes. Nothing if the descriptions need more.
std::optional<std::vector<LasExtraField>> lasExtraFields(std::span<const std::byte> descriptors,
                                                         const LasPointFormat& format, std::size_t pointBytes);

/// Data kept from LAS to LAS.
struct LasBaggage final : FormatBaggage {
  std::vector<std::byte> head, tail;  ///< the file's bytes before and behind its points
  std::vector<std::byte> descriptors;
  LengthUnit unit = LengthUnit::unknown;  ///< according to its coordinate system
  unsigned colorStep = 257;               ///< size of an 8-bit step in the file's 16-bit colours: 1, 256 or 257
};

/// palpate's own record, which stores comments.
inline constexpr std::string_view kLasOurs = "palpate";
inline constexpr unsigned kLasComments = 1;
inline constexpr std::string_view kLasSpec = "LASF_Spec";
inline constexpr unsigned kLasExtraBytes = 4;
/// Extra attributes that are normals.
inline constexpr std::array<std::string_view, 3> kLasNormals{"NormalX", "NormalY", "NormalZ"};
/// Attributes for colours that 8 bits cannot represent.
inline constexpr std::array<std::string_view, 3> kLasFineColors{"red16", "green16", "blue16"};

}  // namespace palpate
