// E57: conversion of its numbers, poses of several scans, and damaged files.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/e57_scans.hpp"
#include "tests/io/e57_bytes.hpp"
#include "tests/io/las_points.hpp"

namespace palpate::test::e57_format_test {

namespace {

const doctest::skip kNeedsXml(!canReadE57());

StoredCloud readingE57(const std::string& text, Log* log = nullptr) { return readingFile("a.e57", text, {}, log); }

std::vector<double> ramp(int count, double begin, double step) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(begin + i * step);
  return values;
}

std::vector<std::int64_t> cycle(int count, std::int64_t least, std::int64_t most) {
  std::vector<std::int64_t> values;
  for (int i = 0; i < count; ++i) values.push_back(least + (i * 7) % (most - least + 1));
  return values;
}

constexpr int kCount = 3000;  // enough for several packets per stream

E57Part scanOf(bool single) {
  return {
      .points = kCount,
      .streams = {
          floats("cartesianX", ramp(kCount, 1, 0.25), single), floats("cartesianY", ramp(kCount, -2, 0.5), single),
          integers("cartesianZ", cycle(kCount, -500, 700), -1000, 1000, "scale=\"0.001\" offset=\"5\""),
          integers("intensity", cycle(kCount, 3, 1000), 3, 2000), integers("colorRed", cycle(kCount, 0, 255), 0, 255),
          integers("colorGreen", cycle(kCount, 0, 255), 0, 255), integers("colorBlue", cycle(kCount, 9, 9), 0, 255)}};
}

}  // namespace

TEST_CASE("E57 integers of any width, scaled integers and floats are read as they were written" * kNeedsXml) {
  for (const bool single : {true, false}) {
    E57Bytes file;
    file.add(scanOf(single));
    const StoredCloud stored = readingE57(file.text());
    REQUIRE(stored.cloud.size() == kCount);
    CHECK(stored.lost.empty());
    const auto z = cycle(kCount, -500, 700), intensity = cycle(kCount, 3, 1000), red = cycle(kCount, 0, 255);
    bool same = true;
    for (std::size_t i = 0; i < kCount; ++i) {
      const double number = static_cast<double>(i);
      same = same && stored.cloud.fileCoordinates(i) ==
                         DVec3(1 + 0.25 * number, -2 + 0.5 * number, static_cast<double>(z[i]) * 0.001 + 5);
      same = same && valueOf(stored.cloud, "intensity", i) == static_cast<double>(intensity[i]);
      same = same && stored.cloud.colors[i] == std::array<std::uint8_t, 4>{static_cast<std::uint8_t>(red[i]),
                                                                           static_cast<std::uint8_t>(red[i]), 9, 255};
    }
    CHECK(same);
  }
  for (const std::int64_t most :
       {std::int64_t{1}, std::int64_t{2}, std::int64_t{255}, std::int64_t{256}, std::int64_t{65535},
        std::int64_t{65536}, std::int64_t{1} << 33, std::int64_t{1} << 51}) {
    CAPTURE(most);
    E57Bytes file;
    std::vector<std::int64_t> values;
    for (int i = 0; i < kCount; ++i) values.push_back(i % 2 ? most - i % (most + 1) : i % (most + 1));
    E57Part part = scanOf(true);
    part.streams[3] = integers("deep", values, 0, most);
    file.add(part);
    const PointCloud cloud = readingE57(file.text()).cloud;
    bool same = true;
    for (std::size_t i = 0; i < kCount; ++i) same = same && valueOf(cloud, "deep", i) == static_cast<double>(values[i]);
    CHECK(same);
  }
}

TEST_CASE("a constant E57 field, stored in no bits, is read" * kNeedsXml) {
  E57Bytes file;
  E57Part part = scanOf(true);
  part.streams[3] = {.xml = "<intensity type=\"Integer\" minimum=\"77\" maximum=\"77\"/>"};
  file.add(part);
  CHECK(valueOf(readingE57(file.text()).cloud, "intensity", 2999) == 77);
}

TEST_CASE("E57 scans are placed by their poses, in double precision" * kNeedsXml) {
  E57Bytes file;
  E57Part one = scanOf(false), other = one;
  const double half = std::sqrt(0.5);
  other.more = "<name>second</name><pose type=\"Structure\"><rotation><w>" + std::to_string(half) +
               "</w><x/><y>0</y><z>" + std::to_string(half) +
               "</z></rotation><translation><x>500000.125</x><y>4000000.5</y><z>-3</z></translation></pose>";
  other.streams[3] = floats("gloss", ramp(kCount, 0, 1), true);
  file.add(one);
  file.add(other);
  file.xmlBehind = "<images2D type=\"Vector\"><vectorChild/></images2D>";
  const StoredCloud stored = readingE57(file.text());
  REQUIRE(stored.cloud.size() == 2 * kCount);
  for (std::size_t i = 0; i < kCount; i += 333) {
    const DVec3 p = stored.cloud.fileCoordinates(i);
    const DVec3 expected(-p.y + 500000.125, p.x + 4000000.5, p.z - 3);  // a rotation of 90 degrees about z
    CHECK(glm::length(stored.cloud.fileCoordinates(kCount + i) - expected) < 2e-9);
  }
  CHECK(valueOf(stored.cloud, "scan", kCount - 1) == 0);
  CHECK(valueOf(stored.cloud, "scan", kCount) == 1);
  CHECK(stored.cloud.hasColors());
  CHECK(stored.lost == std::vector<std::string>{"'intensity', which not all scans have",
                                                "'gloss', which not all scans have",
                                                "the pose of a scan, which is applied", "1 pictures"});
}

TEST_CASE("spherical E57 coordinates become Cartesian ones; points without an echo are left out and counted" *
          kNeedsXml) {
  E57Bytes file;
  E57Part part{.points = 4,
               .streams = {floats("sphericalRange", {2, 3, 4, 5}, false),
                           floats("sphericalAzimuth", {0, std::acos(0.0), 0, 1}, false),
                           floats("sphericalElevation", {0, 0, std::acos(0.0), 1}, false),
                           integers("sphericalInvalidState", {0, 0, 0, 2}, 0, 2)}};
  file.add(part);
  Log log(true);
  const StoredCloud stored = readingE57(file.text(), &log);
  REQUIRE(stored.cloud.size() == 3);
  CHECK(glm::length(stored.cloud.fileCoordinates(0) - DVec3(2, 0, 0)) < 1e-12);
  CHECK(glm::length(stored.cloud.fileCoordinates(1) - DVec3(0, 3, 0)) < 1e-12);
  CHECK(glm::length(stored.cloud.fileCoordinates(2) - DVec3(0, 0, 4)) < 1e-12);
  CHECK(stored.lost == std::vector<std::string>{"1 point without coordinates"});
}

TEST_CASE("E57 normals are rotated with their scan" * kNeedsXml) {
  E57Bytes file;
  E57Part part = scanOf(true);
  part.more = "<pose><rotation><w>0</w><x>2</x><y>0</y><z>0</z></rotation></pose>";  // 180 degrees about x
  part.streams.push_back(floats("nor:normalX", ramp(kCount, 0, 0), true));
  part.streams.push_back(floats("nor:normalY", ramp(kCount, 0.6, 0), true));
  part.streams.push_back(floats("nor:normalZ", ramp(kCount, 0.8, 0), true));
  file.add(part);
  const StoredCloud stored = readingE57(file.text());
  const PointCloud& cloud = stored.cloud;
  REQUIRE(cloud.hasNormals());
  CHECK(std::ranges::any_of(stored.lost, [](const std::string& what) {
    return what.starts_with("the length 2 of the rotation of scan") && what.ends_with("which counts as 1");
  }));
  CHECK(glm::length(cloud.normals[5] - Vec3(0, -0.6f, -0.8f)) < 1e-6f);
}

TEST_CASE("E57 colours are scaled to 8 bits by the limits that the file gives" * kNeedsXml) {
  E57Bytes file;
  E57Part part = scanOf(true);
  for (const std::size_t k : {4, 5, 6})
    part.streams[k] = integers(k == 4   ? "colorRed"
                               : k == 5 ? "colorGreen"
                                        : "colorBlue",
                               cycle(kCount, 0, 60000), 0, 65535);
  part.more =
      "<colorLimits><colorRedMinimum>0</colorRedMinimum><colorRedMaximum>65535</colorRedMaximum>"
      "<colorGreenMinimum>0</colorGreenMinimum><colorGreenMaximum>14</colorGreenMaximum></colorLimits>";
  file.add(part);
  const PointCloud cloud = readingE57(file.text()).cloud;
  CHECK(cloud.colors[1000] == std::array<std::uint8_t, 4>{27, 255, 27, 255});
  CHECK(cloud.colors[1][1] == 128);
}

TEST_CASE("an E57 page with a wrong checksum is reported by its number, at any position" * kNeedsXml) {
  E57Bytes file;
  file.add(scanOf(true));
  const std::string good = file.text();
  REQUIRE(refusalOf("a.e57", good) == "read");
  const std::size_t pages = good.size() / 1024;
  for (const std::size_t page : {std::size_t{1}, pages / 2, pages - 1}) {
    std::string text = good;
    text[page * 1024 + 500] ^= 4;
    refuses(
        "a.e57", text,
        fmt::format(": byte {}: page {} of {} is damaged: its checksum does not fit", page * 1024, page + 1, pages));
    text = good;
    text[page * 1024 + 1022] ^= 4;  // in the checksum itself
    refuses("a.e57", text, fmt::format("...page {} of...", page + 1));
  }
  refuses("a.e57", good.substr(0, 3000), ": byte 3000: the file ends inside page 3...");
  refuses("a.e57", "ASTM-E58", ": is not an E57 file");
  refuses("a.e57", good.substr(0, good.size() - 1024), "...the file ends after...");
}

TEST_CASE("invalid E57 content under valid checksums is refused with its byte" * kNeedsXml) {
  E57Bytes file;
  file.add(scanOf(true));
  const std::string good = E57Bytes::unpaged(file.text());
  const auto with = [&](std::size_t at, auto value, const char* expected) {
    std::string logical = good;
    putAt(logical, at, value);
    refuses("a.e57", E57Bytes::paged(logical), expected);
  };
  const auto xml = [&](const std::string& what, const std::string& otherwise, const char* expected) {
    std::string logical = good;
    logical.replace(logical.find(what), what.size(), otherwise);
    refuses("a.e57", E57Bytes::paged(logical), expected);
  };
  refuses("a.e57", E57Bytes::paged(good), "read");
  with(8, std::uint32_t{2}, ": byte 8: E57 version 2...");
  with(24, std::uint64_t{1} << 40, ": byte 24: refers to byte...");
  with(24, std::uint64_t{1022}, ": byte 24: refers to byte 1022, which holds no data...");
  with(32, std::uint64_t{1} << 40, ": byte 24: refers to 1099511627776 bytes...");
  with(40, std::uint64_t{512}, ": byte 40: pages of 512...");
  with(48, std::uint8_t{7}, ": byte 48: no section of points...");
  with(56, std::uint64_t{1} << 50, ": byte 56: refers to...");
  with(64, std::uint64_t{8}, ": byte 64: the points begin at byte 8, outside...");
  with(80, std::uint8_t{9}, ": byte 80: a packet of kind 9...");
  with(86, std::uint16_t{0xfffb}, ": byte 86: a packet of...");
  with(86, std::uint16_t{2}, ": byte 86: a packet of 3 bytes...");
  with(88, std::uint16_t{3}, ": byte 88: a packet of 3 streams; the points have 7...");
  with(90, std::uint16_t{0xffff}, ": byte 90: stream 1 has 65535 bytes...");
  xml("recordCount=\"3000\"", "recordCount=\"3001\"", "...3001 points has 3000 values of cartesianX...");
  xml("recordCount=\"3000\"", "recordCount=\"3e00\"", "...; expected a number...");
  xml("</prototype>", "</prototypo>", "...not valid XML...");
  xml("e57Root", "e57Ruut", ": ...");
  xml("cartesianX", "cartesianQ", "...has no coordinates of its points...");
  xml("\"Float\"", "\"Flout\"", "...'Flout'...");
  E57Bytes packed;
  packed.codecs = "<vectorChild/>";
  packed.add(scanOf(true));
  refuses("a.e57", packed.text(), "...has an unknown encoding...");
  E57Bytes nothing;
  nothing.add({.points = 1'000'000'000'000,
               .streams = {{.xml = "<cartesianX type=\"Integer\" minimum=\"1\" maximum=\"1\"/>"}}});
  refuses("a.e57", nothing.text(), "...stores no data...");
}

TEST_CASE("E57 files of the reference implementation are read as their headers say" * kNeedsXml) {
  const std::filesystem::path folder = scannedFiles();
  if (folder.empty()) return;
  const PointCloud bunny = readCloud(folder / "bunnyInt32.e57").cloud;
  REQUIRE(bunny.size() == 30571);
  const Bounds box = boundsOf(bunny);
  CHECK(glm::length(box.min + bunny.origin - DVec3(-0.094689, 0.040011, -0.061873)) < 1e-7);
  CHECK(glm::length(box.max + bunny.origin - DVec3(0.061009, 0.187321, 0.058799)) < 1e-7);
  const PointCloud cube = readCloud(folder / "ColouredCubeFloat.e57").cloud;
  REQUIRE(cube.size() == 7680);
  CHECK(cube.hasColors());
  bool onFaces = true;
  for (const Vec3& p : cube.positions)
    onFaces = onFaces && std::abs(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 0.5f) < 1e-6f;
  CHECK(onFaces);
  CHECK_THROWS_WITH_AS(readCloud(folder / "bad-crc.e57"), doctest::Contains("byte 0: page 1 of 1 is damaged"),
                       FileError);
}

TEST_CASE("a build without the XML library refuses E57 with that reason" * doctest::skip(canReadE57())) {
  E57Bytes file;
  file.add(scanOf(true));
  refuses("a.e57", file.text(), "...E57 needs the library pugixml...");
}

}  // namespace palpate::test::e57_format_test
