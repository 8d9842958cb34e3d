// Reading LAS: conversion of the numbers of points, and damaged files.
#include "engine/io/las_format.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/io/damage.hpp"
#include "tests/io/las_points.hpp"

namespace palpate::test::las_reading_test {

using Color = std::array<std::uint8_t, 4>;

TEST_CASE("LAS files with any number of points are read, also on many threads") {
  for (const std::int32_t count : {0, 1, 4095, 4096, 65'537}) {
    CAPTURE(count);
    const std::string text = fileOf(3, count).text();
    const PointCloud cloud = reading(text).cloud;
    REQUIRE(cloud.size() == static_cast<std::size_t>(count));
    if (count > 0) checkPoint(cloud, 3, cloud.size() - 1);
    CHECK(pointsOf(written(cloud)) == pointsOf(text));
  }
}

TEST_CASE("LAS coordinates far from zero keep every bit, with any step") {
  for (const double step : {0.01, 1.16451354e-06, 0.001, -0.25}) {
    CAPTURE(step);
    LasBytes las{.step = {step, step, 3 * step}, .offset = {637012.25, 4850000, -12.125}};
    std::vector<std::array<std::int32_t, 3>> numbers;
    for (int i = 0; i < 1000; ++i) numbers.push_back({i * 7919, 100000 - i * 31, i * i});
    numbers.push_back({2147483647, -2147483647 - 1, 0});  // the largest possible distance
    for (std::size_t n = 1000; n <= numbers.size(); ++n) {
      las.points.clear();
      las.count = n;
      for (std::size_t i = 0; i < n; ++i) {
        std::string point(20, '\0');
        for (std::size_t k = 0; k < 3; ++k) putAt(point, 4 * k, numbers[i][k]);
        las.points += point;
      }
      const PointCloud cloud = reading(las.text()).cloud;
      REQUIRE(cloud.size() == n);
      bool same = true;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          const double truth = numbers[i][k] * (k == 2 ? 3 * step : step) + las.offset[k];
          same = same && cloud.fileCoordinates(i)[static_cast<int>(k)] == truth;
        }
      CHECK(same);
      CHECK(pointsOf(written(cloud)) == las.points);
    }
  }
}

TEST_CASE("16-bit LAS colours that hold 8 bits become 8-bit ones, and others lose no bit") {
  const auto file = [](std::vector<std::array<unsigned, 3>> colors) {
    LasBytes las{.format = 2, .pointBytes = 26};
    for (const auto& color : colors) {
      std::string point(26, '\0');
      for (std::size_t k = 0; k < 3; ++k) putAt(point, 20 + 2 * k, static_cast<std::uint16_t>(color[k]));
      las.points += point;
      ++las.count;
    }
    return las.text();
  };
  const Color expected{255, 7, 128, 255};
  for (const unsigned step : {1u, 256u, 257u}) {
    CAPTURE(step);
    const std::string text = file({{255 * step, 7 * step, 128 * step}, {0, step, 2 * step}});
    const PointCloud cloud = reading(text).cloud;
    REQUIRE(cloud.hasColors());
    CHECK(cloud.colors[0] == expected);
    CHECK(cloud.colors[1] == Color{0, 1, 2, 255});
    CHECK(cloud.extra.empty());
    CHECK(pointsOf(written(cloud)) == pointsOf(text));
  }
  const std::string fine = file({{65535, 300, 1}, {258, 0, 40000}});
  PointCloud cloud = reading(fine).cloud;
  CHECK(cloud.colors[0] == Color{255, 1, 0, 255});
  CHECK(namesOf(cloud) == std::vector<std::string>{"red16", "green16", "blue16"});
  CHECK(pointsOf(written(cloud)) == pointsOf(fine));
  cloud.colors[1] = {10, 20, 30, 255};  // painted
  const PointCloud painted = reading(written(cloud)).cloud;
  CHECK(painted.colors[1] == cloud.colors[1]);
  CHECK(valueOf(painted, "green16", 0) == 300);
  CHECK(valueOf(painted, "green16", 1) == 20 * 257);
  CHECK(!reading(file({{0, 0, 0}})).cloud.hasColors());
}

TEST_CASE("LAS extra bytes become attributes with their names, as their descriptors say") {
  LasBytes las{.minor = 4, .format = 0, .pointBytes = 20 + 2 + 6 + 8 + 2 + 4 + 3};
  las.records = lasRecord("LASF_Spec", 4,
                          lasDescriptor("height above", 4, 24, 0.5, 10) + lasDescriptor("triple", 23) +
                              lasDescriptor("big", 7) + lasDescriptor("pad", 0, 2) + lasDescriptor("x", 9));
  las.recordCount = 1;
  for (int i = 0; i < 50; ++i) {
    std::string point(45, '\0');
    putAt(point, 20, static_cast<std::int16_t>(i - 25));
    for (std::size_t k = 0; k < 3; ++k)
      putAt(point, 22 + 2 * k, static_cast<std::uint16_t>(i * 100 + static_cast<int>(k)));
    putAt(point, 28, std::uint64_t{1} << i);
    putAt(point, 36, static_cast<std::uint16_t>(i * 3));
    putAt(point, 38, 0.25f * static_cast<float>(i));
    point.replace(42, 3, "abc");
    las.points += point;
    ++las.count;
  }
  const StoredCloud stored = reading(las.text());
  const PointCloud& cloud = stored.cloud;
  CHECK(namesOf(cloud) == std::vector<std::string>{"height_above", "triple_0", "triple_1", "triple_2", "big", "pad_0",
                                                   "pad_1", "x_2", "extra_byte_0", "extra_byte_1", "extra_byte_2"});
  CHECK(valueOf(cloud, "height_above", 0) == -2.5);
  CHECK(valueOf(cloud, "triple_2", 7) == 702);
  CHECK(valueOf(cloud, "big", 49) == std::ldexp(1.0, 49));
  CHECK(valueOf(cloud, "x_2", 3) == 0.75);
  CHECK(valueOf(cloud, "extra_byte_1", 3) == 'b');
  CHECK(stored.lost.empty());
  const PointCloud back = reading(written(cloud)).cloud;
  REQUIRE(namesOf(back) == namesOf(cloud));
  for (std::size_t k = 0; k < cloud.extra.size(); ++k) CHECK(back.extra[k].data == cloud.extra[k].data);
  const std::string whole = written(cloud);
  CHECK(pointsOf(whole).substr(0, 45) == las.points.substr(0, 45));

  // Beyond the integers that double precision represents exactly.
  putAt(las.points, 28, (std::uint64_t{1} << 53) + 1);
  CHECK(reading(las.text()).lost == std::vector<std::string>{"whole numbers of 'big' beyond 2^53"});
}

TEST_CASE("a damaged or inconsistent LAS file is refused with its byte") {
  const std::string good = fileOf(3, 10).text();
  const OneOther with{good};
  refuses("a.las", good, "read");
  refuses("a.las", "LAS is no format of mine", ": byte 0: not a LAS file...");
  refuses("a.las", "", ": is empty; it contains no points");
  refuses("a.las", "LASF", ": byte 4: the file ends inside the header...");
  refuses("a.las", good.substr(0, 226), ": byte 226: the file ends inside the header...");
  with(25, std::uint8_t{5}, ": byte 24: LAS version 1.5...");
  with(24, std::uint8_t{2}, ": byte 24: LAS version 2.2...");
  with(94, std::uint16_t{200}, ": byte 94: a header of 200 bytes...");
  with(96, std::uint32_t{100}, ": byte 96: points at byte 100...");
  with(96, std::uint32_t{4000000000}, "...the file ends before its points...");
  with(100, std::uint32_t{1}, ": byte 227: record 1 of 1 reaches into the points...");
  with(104, std::uint8_t{131}, ": byte 104: the points are packed (LAZ), but the record...");
  with(104, std::uint8_t{11}, ": byte 104: point format 11...");
  with(105, std::uint16_t{33}, ": byte 105: points of 33 bytes...");
  with(105, std::uint16_t{34 + 4097}, ": byte 105: points of 4131 bytes; of format 3 at most 4130...");
  with(107, std::uint32_t{11},
       fmt::format(": byte {}: the file ends after 10 of 11 points; it is truncated, or its header is wrong",
                   good.size()));
  with(131, 0.0, ": byte 131: the scale of x is 0...");
  with(139, std::nan(""), ": byte 139: the scale of y is nan...");
  with(155, HUGE_VAL, ": byte 155: the offset of x is inf...");
  LasBytes las = fileOf(6, 3);
  las.tail = lasLongRecord("a", 1, "bcd");
  las.longRecords = 1;
  std::string behind = las.text();
  refuses("a.las", behind, "read");
  refuses("a.las", behind.substr(0, behind.size() - 1), "...record 1 of 1 behind the points is longer...");
  putAt(behind, 235, std::uint64_t{1} << 60);
  refuses("a.las", behind, ": byte 235: records behind the points...");
  putAt(behind, 247, std::uint64_t{1} << 61);
  refuses("a.las", behind, "...the file ends after 5 of 2305843009213693952 points...");
  LasBytes described{.minor = 4, .format = 0, .pointBytes = 21};
  described.records = lasRecord("LASF_Spec", 4, lasDescriptor("wide", 10));
  described.recordCount = 1;
  refuses("a.las", described.text(), ": byte 375: describes more extra bytes than the 1...");
}

TEST_CASE("flipped, cut or extreme bytes in a LAS file are read or refused, without a crash") {
  LasBytes las = fileOf(10, 40);
  las.pointBytes += 3;
  las.points.clear();
  for (int i = 0; i < 40; ++i) las.points += pointOf(10, i) + "abc";
  las.records = lasRecord("LASF_Spec", 4, lasDescriptor("a", 1) + lasDescriptor("b", 3, 24, 0.1, 1)) +
                lasRecord("palpate", 1, "comment units: m\n");
  las.recordCount = 2;
  las.tail = lasLongRecord("x", 1, "yz");
  las.longRecords = 1;
  const std::string good = las.text();
  refuses("a.las", good, "read");
  checkDamaged(good, ".las", 375 + 500, 1500, {100, 1400});
}

TEST_CASE("LAS files of laser scanners are read as their headers say") {
  const std::filesystem::path folder = scannedFiles();
  if (folder.empty()) return;
  struct Truth {
    const char* name;
    std::size_t points;
    bool colors, sameHead;
  };
  for (const Truth& truth : {Truth{"simple.las", 1065, true, true}, Truth{"simple1_3.las", 999, false, false},
                             Truth{"test1_4.las", 1000, false, false}, Truth{"extrabytes.las", 1065, true, true}}) {
    CAPTURE(std::string(truth.name));
    const StoredCloud stored = readCloud(folder / truth.name);
    CHECK(stored.cloud.size() == truth.points);
    CHECK(stored.cloud.hasColors() == truth.colors);
    const std::string text = bytesOf(folder / truth.name), back = written(stored.cloud);
    CHECK(pointsOf(back) == pointsOf(text));
    CHECK(back.size() == text.size());
    if (truth.sameHead) CHECK(back == text);  // the headers of the other files have wrong bounding boxes
  }
  const PointCloud simple = readCloud(folder / "simple.las").cloud;
  const Bounds box = boundsOf(simple);
  CHECK(glm::length(box.min + simple.origin - DVec3(635619.85, 848899.70, 406.59)) < 1e-2);
  CHECK(glm::length(box.max + simple.origin - DVec3(638982.55, 853535.43, 586.38)) < 1e-2);
}

}  // namespace palpate::test::las_reading_test
