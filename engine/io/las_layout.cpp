#include "engine/io/las_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <set>

#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"

namespace palpate {

namespace {

static_assert(std::endian::native == std::endian::little, "LAS is little endian, and is read as it is");

std::string textAt(std::span<const std::byte> bytes, std::size_t at, std::size_t longest) {
  const auto* text = reinterpret_cast<const char*>(bytes.data() + at);
  return {text, std::find(text, text + longest, '\0')};
}

void readLateFields(std::span<const std::byte> begin, LasHeader& header) {
  if (header.minor >= 3) header.waveformsAt = loadScalar<std::uint64_t>(begin, 227);
  if (header.minor < 4) return;
  header.longRecordsAt = loadScalar<std::uint64_t>(begin, 235);
  header.longRecords = loadScalar<std::uint32_t>(begin, 243);
  if (header.longRecords == 0) header.longRecordsAt = 0;
  // Some programs set only the older field.
  if (const auto points = loadScalar<std::uint64_t>(begin, 247)) header.points = points;
}

CoordinateGrid readGrid(const std::filesystem::path& file, std::span<const std::byte> begin) {
  constexpr double kLargestStep = 1e20, kFarthest = 1e29;  // coordinates stay below 1e30
  CoordinateGrid grid;
  for (int k = 0; k < 3; ++k) {
    const std::size_t stepAt = 131 + 8 * static_cast<std::size_t>(k), offsetAt = stepAt + 24;
    grid.step[k] = loadScalar<double>(begin, stepAt);
    grid.offset[k] = loadScalar<double>(begin, offsetAt);
    if (!std::isnormal(grid.step[k]) || !(std::abs(grid.step[k]) < kLargestStep))
      throw FileError::atByte(
          file, stepAt,
          fmt::format("the scale of {} is {}; expected a number other than zero", "xyz"[k], grid.step[k]));
    if (!(std::abs(grid.offset[k]) < kFarthest))
      throw FileError::atByte(
          file, offsetAt, fmt::format("the offset of {} is {}; expected a finite number", "xyz"[k], grid.offset[k]));
  }
  return grid;
}

// Real files have some tens of bytes; each is a named attribute.
constexpr std::size_t kMaxExtraBytes = 4096;

void checkPointBytes(const std::filesystem::path& file, const LasHeader& header) {
  const std::size_t least = lasPointFormat(header.format).bytes;
  if (header.pointBytes < least)
    throw FileError::atByte(file, 105,
                            fmt::format("points of {} bytes; those of format {} have at least {}", header.pointBytes,
                                        header.format, least));
  if (header.pointBytes > least + kMaxExtraBytes)
    throw FileError::atByte(file, 105,
                            fmt::format("points of {} bytes; of format {} at most {} are read", header.pointBytes,
                                        header.format, least + kMaxExtraBytes));
}

void checkPlaces(const std::filesystem::path& file, const LasHeader& header) {
  const std::size_t least = header.minor == 4 ? kLasHeader14 : header.minor == 3 ? kLasHeader13 : kLasShortHeader;
  if (header.size < least)
    throw FileError::atByte(
        file, 94, fmt::format("a header of {} bytes; version 1.{} has at least {}", header.size, header.minor, least));
  if (header.pointsAt < header.size)
    throw FileError::atByte(file, 96,
                            fmt::format("points at byte {}, inside the header of {}", header.pointsAt, header.size));
}

// Indexed by the type number of the specification minus 1.
constexpr std::array<ScalarType, 10> kExtraTypes{ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16,
                                                 ScalarType::u32, ScalarType::i32, ScalarType::u64, ScalarType::i64,
                                                 ScalarType::f32, ScalarType::f64};

/// The stored number of missing values, which a descriptor holds as the largest type of its kind.
double noDataOf(std::span<const std::byte> descriptor, std::size_t element, ScalarType type) {
  const std::size_t at = 40 + 8 * std::min<std::size_t>(element, 2);
  if (isFloating(type)) return loadScalar<double>(descriptor, at);
  const bool isSigned =
      type == ScalarType::i8 || type == ScalarType::i16 || type == ScalarType::i32 || type == ScalarType::i64;
  return isSigned ? static_cast<double>(loadScalar<std::int64_t>(descriptor, at))
                  : static_cast<double>(loadScalar<std::uint64_t>(descriptor, at));
}

/// Makes names valid in text files, and unique.
class NamesInUse {
 public:
  explicit NamesInUse(const LasPointFormat& format) {
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha", "r", "g", "b", "a"})
      names_.insert(name);
    for (const std::string_view name : kLasFineColors) names_.emplace(name);
    for (const LasField& field : format.fields) names_.insert(field.name);
  }
  std::string next(std::string name) {
    for (char& c : name)
      if (c <= ' ' || c > '~' || c == ',' || c == ';') c = '_';
    if (name.empty()) name = "extra";
    const std::string first = name;
    for (int number = 2; !names_.insert(name).second; ++number) name = fmt::format("{}_{}", first, number);
    return name;
  }

 private:
  std::set<std::string> names_;
};

void addWaves(LasPointFormat& format) {
  const std::size_t at = format.bytes;
  format.fields.push_back({.name = "wave_packet_descriptor", .at = at});
  format.fields.push_back({.name = "wave_packet_offset", .at = at + 1, .type = ScalarType::u64});
  format.fields.push_back({.name = "wave_packet_size", .at = at + 9, .type = ScalarType::u32});
  std::size_t next = at + 13;
  for (const char* name : {"return_point_wave_location", "wave_x_t", "wave_y_t", "wave_z_t"}) {
    format.fields.push_back({.name = name, .at = next, .type = ScalarType::f32});
    next += 4;
  }
  format.bytes = next;
  format.hasWaves = true;
}

void addBits(LasPointFormat& format, std::size_t at, std::initializer_list<std::pair<const char*, unsigned>> names) {
  unsigned shift = 0;
  for (const auto& [name, bits] : names) {
    format.fields.push_back({.name = name, .at = at, .shift = shift, .bits = bits});
    shift += bits;
  }
}

void addCore(LasPointFormat& format, bool extended) {
  format.fields.push_back({.name = "intensity", .at = 12, .type = ScalarType::u16});
  if (extended) {
    addBits(format, 14, {{"return_number", 4}, {"number_of_returns", 4}});
    addBits(format, 15,
            {{"synthetic", 1},
             {"key_point", 1},
             {"withheld", 1},
             {"overlap", 1},
             {"scanner_channel", 2},
             {"scan_direction_flag", 1},
             {"edge_of_flight_line", 1}});
    format.fields.push_back({.name = "classification", .at = 16});
    format.fields.push_back({.name = "user_data", .at = 17});
    format.fields.push_back({.name = "scan_angle", .at = 18, .type = ScalarType::i16});
    format.fields.push_back({.name = "point_source_id", .at = 20, .type = ScalarType::u16});
    format.bytes = 22;
    return;
  }
  addBits(format, 14,
          {{"return_number", 3}, {"number_of_returns", 3}, {"scan_direction_flag", 1}, {"edge_of_flight_line", 1}});
  addBits(format, 15, {{"classification", 5}, {"synthetic", 1}, {"key_point", 1}, {"withheld", 1}});
  format.fields.push_back({.name = "scan_angle_rank", .at = 16, .type = ScalarType::i8});
  format.fields.push_back({.name = "user_data", .at = 17});
  format.fields.push_back({.name = "point_source_id", .at = 18, .type = ScalarType::u16});
}

}  // namespace

LasHeader readLasHeader(const std::filesystem::path& file, std::span<const std::byte> begin) {
  const std::string magic = textAt(begin, 0, std::min<std::size_t>(4, begin.size()));
  if (magic != "LASF") throw FileError(file, "is not a LAS file");
  const auto need = [&](std::size_t bytes) {
    if (begin.size() < bytes)
      throw FileError::atByte(file, begin.size(), fmt::format("the file ends inside the header of {} bytes", bytes));
  };
  need(kLasShortHeader);
  LasHeader header;
  header.minor = loadScalar<std::uint8_t>(begin, 25);
  if (loadScalar<std::uint8_t>(begin, 24) != 1 || header.minor > 4)
    throw FileError::atByte(
        file, 24,
        fmt::format("LAS version {}.{}; 1.0 to 1.4 are read", loadScalar<std::uint8_t>(begin, 24), header.minor));
  header.size = loadScalar<std::uint16_t>(begin, 94);
  header.pointsAt = loadScalar<std::uint32_t>(begin, 96);
  header.records = loadScalar<std::uint32_t>(begin, 100);
  header.format = loadScalar<std::uint8_t>(begin, 104);
  header.pointBytes = loadScalar<std::uint16_t>(begin, 105);
  header.points = loadScalar<std::uint32_t>(begin, 107);
  checkPlaces(file, header);
  need(header.size);
  constexpr unsigned kPacked = 0x80;
  header.packed = header.format & kPacked;
  header.format &= ~kPacked;
  if (header.format >= kLasFormats)
    throw FileError::atByte(file, 104,
                            fmt::format("point format {}; 0 to {} are read", header.format, kLasFormats - 1));
  checkPointBytes(file, header);
  header.grid = readGrid(file, begin);
  readLateFields(begin, header);
  return header;
}

namespace {

// `count` records starting at byte `at`; each header contains the length of its record. `beyond` makes the error for a
// record (its number, and the byte where it begins) that exceeds the end.
template <class Length>
std::vector<LasRecord> recordsFrom(std::span<const std::byte> bytes, std::size_t at, std::uint32_t count,
                                   std::size_t headBytes,
                                   const std::function<FileError(std::uint32_t, std::size_t)>& beyond) {
  std::vector<LasRecord> records;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::size_t left = bytes.size() - at;
    const std::uint64_t length = left < headBytes ? 0 : loadScalar<Length>(bytes, at + 20);
    if (left < headBytes || left - headBytes < length) throw beyond(k + 1, at);
    records.push_back({.user = textAt(bytes, at + 2, 16),
                       .id = loadScalar<std::uint16_t>(bytes, at + 18),
                       .at = at,
                       .head = bytes.subspan(at, headBytes),
                       .data = bytes.subspan(at + headBytes, length)});
    at += headBytes + length;
  }
  return records;
}

}  // namespace

std::vector<LasRecord> lasRecords(const std::filesystem::path& file, const LasHeader& header,
                                  std::span<const std::byte> head) {
  return recordsFrom<std::uint16_t>(
      head, header.size, header.records, kLasRecordHead, [&](std::uint32_t number, std::size_t at) {
        return FileError::atByte(
            file, at,
            fmt::format("record {} of {} reaches into the points at byte {}", number, header.records, head.size()));
      });
}

std::vector<LasRecord> lasLongRecords(const std::filesystem::path& file, const LasHeader& header,
                                      std::span<const std::byte> tail, std::uint64_t tailAt) {
  if (header.longRecords == 0) return {};
  if (header.longRecordsAt < tailAt || header.longRecordsAt - tailAt > tail.size())
    throw FileError::atByte(file, 235,
                            fmt::format("records behind the points at byte {}; those bytes are {} to {}",
                                        header.longRecordsAt, tailAt, tailAt + tail.size()));
  return recordsFrom<std::uint64_t>(
      tail, header.longRecordsAt - tailAt, header.longRecords, kLasLongRecordHead,
      [&](std::uint32_t number, std::size_t at) {
        return FileError::atByte(
            file, tailAt + at,
            fmt::format("record {} of {} behind the points is longer than the file", number, header.longRecords));
      });
}

LasPointFormat lasPointFormat(unsigned number) {
  LasPointFormat format;
  const bool extended = number >= 6;
  addCore(format, extended);
  format.hasTime = extended || number == 1 || number >= 3;
  if (format.hasTime) {
    format.fields.push_back({.name = "gps_time", .at = format.bytes, .type = ScalarType::f64});
    format.bytes += 8;
  }
  if (number == 2 || number == 3 || number == 5 || number == 7 || number == 8 || number == 10) {
    format.colorAt = format.bytes;
    format.bytes += 6;
  }
  format.hasInfrared = number == 8 || number == 10;
  if (format.hasInfrared) {
    format.fields.push_back({.name = "nir", .at = format.bytes, .type = ScalarType::u16});
    format.bytes += 2;
  }
  if (number == 4 || number == 5 || number == 9 || number == 10) addWaves(format);
  return format;
}

unsigned lasFormatWith(bool extended, bool time, bool color, bool infrared, bool waves) {
  for (unsigned number = extended || infrared ? 6 : 0; number < kLasFormats; ++number) {
    const LasPointFormat format = lasPointFormat(number);
    if (format.hasTime >= time && (format.colorAt > 0) >= color && format.hasInfrared >= infrared &&
        format.hasWaves >= waves)
      return number;
  }
  return kLasFormats - 1;
}

std::optional<std::vector<LasExtraField>> lasExtraFields(std::span<const std::byte> descriptors,
                                                         const LasPointFormat& format, std::size_t pointBytes) {
  std::vector<LasExtraField> fields;
  const std::size_t described = descriptors.size() / kLasDescriptor;
  std::size_t at = format.bytes;
  NamesInUse names(format);
  for (std::size_t k = 0; k < described; ++k) {
    const auto one = descriptors.subspan(k * kLasDescriptor, kLasDescriptor);
    const unsigned code = loadScalar<std::uint8_t>(one, 2), options = loadScalar<std::uint8_t>(one, 3);
    const bool known = code >= 1 && code <= 30;  // otherwise `options` is the number of bytes
    const ScalarType type = known ? kExtraTypes[(code - 1) % 10] : kExtraTypes[0];
    const std::size_t elements = known ? 1 + (code - 1) / 10 : options;
    const std::string name = textAt(one, 4, 32);
    for (std::size_t e = 0; e < elements; ++e) {
      LasField field{
          .name = names.next(known && elements == 1 ? name : fmt::format("{}_{}", name, e)), .at = at, .type = type};
      const double scale = loadScalar<double>(one, 112 + 8 * std::min<std::size_t>(e, 2));
      const double offset = loadScalar<double>(one, 136 + 8 * std::min<std::size_t>(e, 2));
      if (known && (options & 0x18u)) {
        if ((options & 0x08u) && std::isnormal(scale)) field.scale = scale;
        if ((options & 0x10u) && std::isfinite(offset)) field.offset = offset;
        if (options & 0x01u) field.noData = noDataOf(one, e, type);
        field.raw = field.type;
        field.type = ScalarType::f64;
      }
      at += field.storedBytes();
      if (at > pointBytes) return std::nullopt;
      fields.push_back({std::move(field), k});
    }
  }
  for (std::size_t k = 0; at < pointBytes; ++at, ++k)
    fields.push_back({{.name = names.next(fmt::format("extra_byte_{}", k)), .at = at}, described + k});
  return fields;
}

}  // namespace palpate
