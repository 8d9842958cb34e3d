// LAS files with known points in every format, and checks for reader and writer.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/io/file_cases.hpp"
#include "tests/io/las_bytes.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test {

inline std::string bytesOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Reads a file of these bytes.
inline StoredCloud reading(const std::string& text, unsigned threads = 0) {
  return readingFile("a.las", text, {.threads = threads});
}

/// Checks the refusal of a file in which one number is another.
struct OneOther {
  const std::string& good;
  template <class T>
  void operator()(std::size_t at, T value, const std::string& expected) const {
    std::string text = good;
    putAt(text, at, value);
    refuses("a.las", text, expected);
  }
};

inline std::string written(const PointCloud& cloud, const char* ending = ".las") {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / (std::string("b") + ending);
  writeCloud(file, cloud);
  return bytesOf(file);
}

inline std::string again(const std::string& text) { return written(reading(text).cloud); }

inline double valueOf(const PointCloud& cloud, std::string_view name, std::size_t i) {
  for (const Attribute& attribute : cloud.extra)
    if (attribute.name == name)
      return visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
        return static_cast<double>(loadScalar<T>(attribute.data.data() + i * sizeof(T)));
      });
  FAIL("no attribute ", std::string(name));
  return 0;
}

inline std::vector<std::string> namesOf(const PointCloud& cloud) {
  std::vector<std::string> names;
  for (const Attribute& attribute : cloud.extra) names.push_back(attribute.name);
  return names;
}

/// Offsets of the fields of a format, copied from the specification's tables independently of the reader.
struct Places {
  unsigned bytes;
  int time, color, infrared, waves;
};
inline constexpr std::array<Places, 11> kPlaces{{{20, -1, -1, -1, -1},
                                                 {28, 20, -1, -1, -1},
                                                 {26, -1, 20, -1, -1},
                                                 {34, 20, 28, -1, -1},
                                                 {57, 20, -1, -1, 28},
                                                 {63, 20, 28, -1, 34},
                                                 {30, 22, -1, -1, -1},
                                                 {36, 22, 30, -1, -1},
                                                 {38, 22, 30, 36, -1},
                                                 {59, 22, -1, -1, 30},
                                                 {67, 22, 30, 36, 38}}};

inline std::string pointOf(unsigned format, std::int32_t i) {
  const Places& places = kPlaces[format];
  std::string point(places.bytes, '\0');
  putAt(point, 0, 100 * i), putAt(point, 4, -7 * i), putAt(point, 8, i);
  putAt(point, 12, static_cast<std::uint16_t>(1000 + i));
  if (format < 6) {
    putAt(point, 14, std::uint8_t{0b11'101'010});  // edge, direction; 5 returns, this is the second
    putAt(point, 15, std::uint8_t{0b011'00110});   // key point, synthetic; class 6
    putAt(point, 16, std::int8_t{-12});
    putAt(point, 17, std::uint8_t{77});
    putAt(point, 18, std::uint16_t{4321});
  } else {
    putAt(point, 14, std::uint8_t{0b1111'1001});   // 15 returns, this is the ninth
    putAt(point, 15, std::uint8_t{0b10'11'1100});  // edge; channel 3; overlap, withheld
    putAt(point, 16, std::uint8_t{200});
    putAt(point, 17, std::uint8_t{77});
    putAt(point, 18, std::int16_t{-2000});
    putAt(point, 20, std::uint16_t{4321});
  }
  const auto at = [](int place) { return static_cast<std::size_t>(place); };
  if (places.time >= 0) putAt(point, at(places.time), 123456.789 + i);
  if (places.color >= 0)
    for (int k = 0; k < 3; ++k)
      putAt(point, at(places.color + 2 * k), static_cast<std::uint16_t>(257 * (10 * k + i % 9)));
  if (places.infrared >= 0) putAt(point, at(places.infrared), std::uint16_t{60000});
  if (places.waves >= 0) {
    putAt(point, at(places.waves), std::uint8_t{3});
    putAt(point, at(places.waves + 1), std::uint64_t{1} << 40);
    putAt(point, at(places.waves + 9), std::uint32_t{256});
    for (int k = 0; k < 4; ++k) putAt(point, at(places.waves + 13 + 4 * k), 0.5f + static_cast<float>(k));
  }
  return point;
}

inline LasBytes fileOf(unsigned format, std::int32_t count) {
  LasBytes las{.minor = format >= 6   ? 4u
                        : format >= 4 ? 3u
                                      : 2u,
               .format = format,
               .pointBytes = kPlaces[format].bytes};
  las.count = static_cast<std::uint64_t>(count);
  for (std::int32_t i = 0; i < count; ++i) las.points += pointOf(format, i);
  return las;
}

inline std::string pointsOf(const std::string& text) {
  std::uint32_t at = 0;
  std::memcpy(&at, text.data() + 96, sizeof at);
  return text.substr(at);
}

inline void checkPoint(const PointCloud& cloud, unsigned format, std::size_t i) {
  const Places& places = kPlaces[format];
  const auto number = static_cast<double>(i);
  CHECK(cloud.fileCoordinates(i) == DVec3(100 * number * 0.01, -7 * number * 0.01, number * 0.01));
  CHECK(valueOf(cloud, "intensity", i) == static_cast<std::uint16_t>(1000 + i));
  CHECK(valueOf(cloud, "return_number", i) == (format < 6 ? 2 : 9));
  CHECK(valueOf(cloud, "number_of_returns", i) == (format < 6 ? 5 : 15));
  CHECK(valueOf(cloud, "edge_of_flight_line", i) == 1);
  CHECK(valueOf(cloud, "classification", i) == (format < 6 ? 6 : 200));
  CHECK(valueOf(cloud, "user_data", i) == 77);
  CHECK(valueOf(cloud, "point_source_id", i) == 4321);
  const std::vector<std::string> names = namesOf(cloud);
  const auto has = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
  if (format < 6) {
    CHECK(valueOf(cloud, "scan_direction_flag", i) == 1);
    CHECK(valueOf(cloud, "synthetic", i) == 1);
    CHECK(valueOf(cloud, "key_point", i) == 1);
    CHECK(valueOf(cloud, "scan_angle_rank", i) == -12);
    CHECK(!has("withheld"));  // zero for all points
  } else {
    CHECK(valueOf(cloud, "withheld", i) == 1);
    CHECK(valueOf(cloud, "overlap", i) == 1);
    CHECK(valueOf(cloud, "scanner_channel", i) == 3);
    CHECK(valueOf(cloud, "scan_angle", i) == -2000);
    CHECK(!has("synthetic"));
    CHECK(!has("scan_direction_flag"));
  }
  CHECK(has("gps_time") == (places.time >= 0));
  if (places.time >= 0) CHECK(valueOf(cloud, "gps_time", i) == 123456.789 + number);
  CHECK(cloud.hasColors() == (places.color >= 0));
  if (places.color >= 0) CHECK(cloud.colors[i][1] == 10 + i % 9);
  if (places.infrared >= 0) CHECK(valueOf(cloud, "nir", i) == 60000);
  CHECK(has("wave_packet_size") == (places.waves >= 0));
  if (places.waves < 0) return;
  CHECK(valueOf(cloud, "wave_packet_descriptor", i) == 3);
  CHECK(valueOf(cloud, "wave_packet_offset", i) == std::ldexp(1.0, 40));
  CHECK(valueOf(cloud, "wave_packet_size", i) == 256);
  CHECK(valueOf(cloud, "wave_z_t", i) == 3.5);
}

/// Folder of files from laser scanners; empty if it is missing.
inline std::filesystem::path scannedFiles() { return sharedFile("formats/simple.las").parent_path(); }

}  // namespace palpate::test
