// LAS: conversion of the numbers of points, and damaged files; unchanged points are written byte by byte, and
// unavoidable changes are defined.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "engine/cloud/length_unit.hpp"
#include "engine/io/saving.hpp"
#include "tests/io/las_points.hpp"
#include "tests/near.hpp"

namespace palpate::test::las_format_test {

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
  const PointCloud huge = reading(written(reading(las.text()).cloud)).cloud;
  CHECK(loadScalar<std::uint64_t>(huge.extra.at(4).data.data()) == (std::uint64_t{1} << 53) + 1);
}

TEST_CASE("the no-data value of scaled LAS extra bytes is read as a missing number, and written back") {
  LasBytes las{.minor = 4, .format = 0, .pointBytes = 20 + 2 + 4};
  std::string signedBytes = lasDescriptor("depth", 4, 25, 0.01, 5), unsignedBytes = lasDescriptor("code", 5, 9, 0.5);
  putAt(signedBytes, 40, std::int64_t{-9999});
  putAt(unsignedBytes, 40, std::uint64_t{4'000'000'000});
  las.records = lasRecord("LASF_Spec", 4, signedBytes + unsignedBytes);
  las.recordCount = 1;
  for (int i = 0; i < 5; ++i) {
    std::string point(26, '\0');
    putAt(point, 20, static_cast<std::int16_t>(i == 0 ? -9999 : 100 * i));
    putAt(point, 22, i == 1 ? 4'000'000'000u : static_cast<std::uint32_t>(i));
    las.points += point;
    ++las.count;
  }
  const PointCloud cloud = reading(las.text()).cloud;
  CHECK(std::isnan(valueOf(cloud, "depth", 0)));
  CHECK(valueOf(cloud, "depth", 1) == 6);
  CHECK(std::isnan(valueOf(cloud, "code", 1)));
  CHECK(valueOf(cloud, "code", 0) == 0);
  CHECK(pointsOf(written(cloud)) == las.points);
}

TEST_CASE("a damaged or inconsistent LAS file is refused with its byte") {
  const std::string good = fileOf(3, 10).text();
  const OneOther with{good};
  refuses("a.las", good, "read");
  refuses("a.las", "these are words", ": is not a LAS file");
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

TEST_CASE("every LAS point format is read as specified, and written back byte by byte") {
  for (unsigned format = 0; format < kPlaces.size(); ++format) {
    CAPTURE(format);
    const std::string text = fileOf(format, 20).text();
    const StoredCloud stored = reading(text);
    REQUIRE(stored.cloud.size() == 20);
    CHECK(stored.lost.empty());
    for (std::size_t i = 0; i < 20; i += 19) checkPoint(stored.cloud, format, i);
    const std::string back = written(stored.cloud);
    CHECK(back.size() == text.size());
    CHECK(pointsOf(back) == pointsOf(text));
    CHECK(again(back) == back);
  }
}

TEST_CASE("LAS coordinates survive a conversion to PLY or text and back to LAS, bit by bit") {
  const std::string text = fileOf(3, 300).text();
  const StoredCloud stored = reading(text);
  for (const char* name : {"a.ply", "a.xyz"}) {
    const ScratchFolder folder;
    writeCloud(folder / name, stored.cloud);
    const PointCloud back = readCloud(folder / name).cloud;
    REQUIRE(back.size() == stored.cloud.size());
    // In text they are the doubles next to their decimals.
    const double beside = std::string_view(name) == "a.ply" ? 0 : 1e-15;
    for (std::size_t i = 0; i < back.size(); ++i) {
      const DVec3 one = back.fileCoordinates(i), other = stored.cloud.fileCoordinates(i);
      for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(one[axis] - other[axis]) <= beside * std::abs(other[axis]));
    }
    CHECK(back.colors == stored.cloud.colors);
    CHECK(valueOf(back, "gps_time", 5) == valueOf(stored.cloud, "gps_time", 5));
    const PointCloud third = reading(written(back)).cloud;  // LAS again, without the header of the first file
    for (std::size_t i = 0; i < back.size(); ++i) CHECK(third.fileCoordinates(i) == stored.cloud.fileCoordinates(i));
    CHECK(pointsOf(written(back)) == pointsOf(text));
  }
}

TEST_CASE("LAS records before and behind the points are kept, and listed when another format loses them") {
  LasBytes las = fileOf(6, 30);
  las.records = lasRecord("LASF_Projection", 2112, "GEOGCS[...]") + lasRecord("a vendor", 7, std::string(300, '\x7f'));
  las.recordCount = 2;
  las.padding = "\xdd\xcc";
  las.tail = lasLongRecord("LASF_Projection", 2112, "more of it") + lasLongRecord("late", 9, std::string(70000, 'e'));
  las.longRecords = 2;
  const StoredCloud stored = reading(las.text());
  const std::string text = las.text(), back = written(stored.cloud);
  CHECK(back.size() == text.size());
  CHECK(back.substr(375) == text.substr(375));
  CHECK(back.substr(235, 12) == text.substr(235, 12));
  const std::string sentence =
      "4 records of LAS: 'LASF_Projection' 2112, 'a vendor' 7, 'LASF_Projection' 2112, 'late' 9";
  CHECK(lostOnTheWay(stored, cloudFormats().toWrite("a.ply")) == std::vector<std::string>{sentence});
  CHECK(lostOnTheWay(stored, cloudFormats().toWrite("a.las")).empty());

  // An additional attribute moves the records behind the points, and their offsets are updated.
  PointCloud more = stored.cloud;
  more.extra.push_back({"quality", ScalarType::f32, std::vector<std::byte>(4 * more.size(), std::byte{1})});
  const std::string longer = written(more);
  const StoredCloud third = reading(longer);
  CHECK(namesOf(third.cloud).back() == "quality");
  CHECK(third.cloud.extra.back().data == more.extra.back().data);
  CHECK(longer.ends_with(las.tail));
  CHECK(third.cloud.storedAs.baggage->sentence == sentence);
}

TEST_CASE("clouds of other formats are written to LAS without a change, or the change is reported") {
  PointCloud cloud;
  for (int i = 0; i < 700; ++i) {
    cloud.positions.emplace_back(0.25f * static_cast<float>(i), -1.5f, 3);
    cloud.normals.emplace_back(0, i % 2 ? 1 : -1, 0);
    cloud.colors.push_back({static_cast<std::uint8_t>(i), 2, 3, 255});
  }
  const auto attribute = [&](const char* name, auto value) {
    Attribute& added = cloud.extra.emplace_back(Attribute{name, ScalarType::f64, {}});
    for (int i = 0; i < 700; ++i) {
      const double number = value(i);
      const auto* bytes = reinterpret_cast<const std::byte*>(&number);
      added.data.insert(added.data.end(), bytes, bytes + sizeof number);
    }
  };
  attribute("intensity", [](int i) { return 0.5 + i; });  // not an integer, so not LAS's own field
  attribute("classification", [](int i) { return i % 3; });
  attribute("gps_time", [](int i) { return i * 1e-3; });
  cloud.storedAs.comments = {"comment units: mm"};
  markAsOurs(cloud);
  CHECK(lasFormat().lacks(cloud).empty());
  const PointCloud back = reading(written(cloud)).cloud;
  REQUIRE(back.size() == cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) CHECK(back.fileCoordinates(i) == cloud.fileCoordinates(i));
  CHECK(back.normals == cloud.normals);
  CHECK(back.colors == cloud.colors);
  CHECK(valueOf(back, "intensity", 3) == 3.5);
  CHECK(valueOf(back, "classification", 5) == 2);
  CHECK(valueOf(back, "gps_time", 5) == 5 * 1e-3);
  CHECK(isOurs(back.storedAs.comments));
  CHECK(std::ranges::find(back.storedAs.comments, "comment units: mm") != back.storedAs.comments.end());
  CHECK(std::ranges::find(back.storedAs.comments, "comment up: z") != back.storedAs.comments.end());

  StoredCloud rough{.cloud = {}, .triangles = {{0, 0, 0}}, .lost = {}};
  rough.cloud.positions = {{0.1f, 1e-9f, 0}, {1, 2, 3}};
  rough.cloud.storedAs.alpha = true;
  const std::vector<std::string> lost = lostOnTheWay(rough, lasFormat());
  REQUIRE(lost.size() == 3);
  CHECK(lost[0] == "1 triangle");
  CHECK(lost[1] == "the alpha of colours");
  CHECK(lost[2].starts_with("coordinates finer than "));
  const PointCloud roughBack = reading(written(rough.cloud)).cloud;
  for (std::size_t i = 0; i < 2; ++i)
    CHECK(glm::length(roughBack.fileCoordinates(i) - rough.cloud.fileCoordinates(i)) < 3e-9);
  CHECK(reading(written({})).cloud.empty());
}

TEST_CASE("moved points are rounded to the scale of their LAS file if it is fine for their spacing, else to a tenth") {
  // A sheet of points a given number of grid steps apart.
  struct Sheet {
    double step;
    int apart;
    double after;  ///< step of the edited file
  };
  for (const auto& [step, apart, after] :
       {Sheet{0.001, 100, 0.001}, {0.01, 5, 0.01}, {0.01, 3, 0.001}, {0.1, 1, 0.01}, {0.0254, 2, 0.00254}}) {
    CAPTURE(step);
    CAPTURE(apart);
    LasBytes las{.step = {step, step, step}, .offset = {637000.5, 4849000, 0}};
    for (int i = 0; i < 900; ++i) {
      std::string point(20, '\0');
      putAt(point, 0, std::int32_t{apart * (i % 30)});
      putAt(point, 4, std::int32_t{apart * (i / 30)});
      las.points += point;
      ++las.count;
    }
    StoredCloud stored = reading(las.text());
    const PointCloud before = stored.cloud;
    stored.cloud.positions[40] += Vec3(0.37f * static_cast<float>(step), 0, -0.21f * static_cast<float>(step));
    const std::string text = written(stored.cloud);
    double written = 0;
    std::memcpy(&written, text.data() + 131, sizeof written);
    CHECK(written == near(after, 1e-12));
    const PointCloud back = reading(text).cloud;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (i != 40) CHECK(glm::length(back.fileCoordinates(i) - before.fileCoordinates(i)) < 1e-9);
    CHECK(glm::length(back.fileCoordinates(40) - stored.cloud.fileCoordinates(40)) < 0.9 * after);
    const std::vector<std::string> lost = lasFormat().lacks(stored.cloud);
    REQUIRE(lost.size() == 1);
    CHECK(lost[0].starts_with("coordinates finer than "));
    CHECK((lost[0].find("the scale becomes") != std::string::npos) == (after < step));
  }
}

TEST_CASE("a class or return number beyond the old LAS point formats selects a newer one") {
  PointCloud cloud = reading(fileOf(1, 10).text()).cloud;
  for (Attribute& attribute : cloud.extra)
    if (attribute.name == "classification") attribute.data[3] = std::byte{64};
  const std::string text = written(cloud);
  CHECK(static_cast<int>(text[104]) == 6);
  CHECK(static_cast<int>(text[25]) == 4);
  const PointCloud back = reading(text).cloud;
  CHECK(valueOf(back, "classification", 3) == 64);
  CHECK(valueOf(back, "classification", 4) == 6);
  CHECK(valueOf(back, "scan_angle_rank", 4) == -12);  // newer formats store it in another unit
}

TEST_CASE("a fractional intensity keeps its name through LAS and LAZ") {
  const ScratchFolder folder;
  std::ofstream(folder / "a.xyz") << "x y z intensity\n0 0 0 0.25\n1 0 0 0.5\n";
  StoredCloud stored = readCloud(folder / "a.xyz");
  for (const char* name : {"b.las", "c.laz"}) {
    writeCloud(folder / name, stored.cloud);
    stored = readCloud(folder / name);
    REQUIRE(stored.cloud.extra.size() == 1);
    CHECK(stored.cloud.extra[0].name == "intensity");
    CHECK(loadScalar<double>(stored.cloud.extra[0].data.data()) == 0.25);
  }
}

}  // namespace palpate::test::las_format_test
