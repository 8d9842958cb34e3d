// LAS: every format of points, what its numbers become, and that nothing changes on the way through.
#include "engine/io/las_format.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/saving.hpp"
#include "tests/io/damage.hpp"
#include "tests/io/las_bytes.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test {
namespace {

using Color = std::array<std::uint8_t, 4>;

std::string bytesOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

StoredCloud reading(const std::string& text) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.las", std::ios::binary) << text;
  return readCloud(folder / "a.las");
}

std::string refusal(const std::string& text) {
  try {
    reading(text);
  } catch (const FileError& error) {
    const std::string message = error.what();
    return message.substr(message.find(".las") + 4);
  }
  return "read";
}

std::string written(const PointCloud& cloud) {
  const ScratchFolder folder;
  writeCloud(folder / "b.las", cloud);
  return bytesOf(folder / "b.las");
}

std::string again(const std::string& text) { return written(reading(text).cloud); }

double valueOf(const PointCloud& cloud, std::string_view name, std::size_t i) {
  for (const Attribute& attribute : cloud.extra)
    if (attribute.name == name)
      return visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
        return static_cast<double>(loadScalar<T>(attribute.data.data() + i * sizeof(T)));
      });
  FAIL("no attribute ", std::string(name));
  return 0;
}

std::vector<std::string> namesOf(const PointCloud& cloud) {
  std::vector<std::string> names;
  for (const Attribute& attribute : cloud.extra) names.push_back(attribute.name);
  return names;
}

/// Where the specification puts what a format has, written down from its tables once more.
struct Places {
  unsigned bytes;
  int time, color, infrared, waves;
};
constexpr std::array<Places, 11> kPlaces{{{20, -1, -1, -1, -1},
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

std::string pointOf(unsigned format, std::int32_t i) {
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

LasBytes fileOf(unsigned format, std::int32_t count) {
  LasBytes las{.minor = format >= 6   ? 4u
                        : format >= 4 ? 3u
                                      : 2u,
               .format = format,
               .pointBytes = kPlaces[format].bytes};
  las.count = static_cast<std::uint64_t>(count);
  for (std::int32_t i = 0; i < count; ++i) las.points += pointOf(format, i);
  return las;
}

std::string pointsOf(const std::string& text) {
  std::uint32_t at = 0;
  std::memcpy(&at, text.data() + 96, sizeof at);
  return text.substr(at);
}

void checkPoint(const PointCloud& cloud, unsigned format, std::size_t i) {
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
    CHECK(!has("withheld"));  // nothing but zeros
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

}  // namespace

TEST_CASE("every format of points is read as the specification has it, and written back byte by byte") {
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

TEST_CASE("any number of points is read, also on many threads") {
  for (const std::int32_t count : {0, 1, 4095, 4096, 65'537}) {
    CAPTURE(count);
    const std::string text = fileOf(3, count).text();
    const PointCloud cloud = reading(text).cloud;
    REQUIRE(cloud.size() == static_cast<std::size_t>(count));
    if (count > 0) checkPoint(cloud, 3, cloud.size() - 1);
    CHECK(pointsOf(written(cloud)) == pointsOf(text));
  }
}

TEST_CASE("coordinates far from zero keep every bit, in whatever steps") {
  for (const double step : {0.01, 1.16451354e-06, 0.001, -0.25}) {
    CAPTURE(step);
    LasBytes las{.step = {step, step, 3 * step}, .offset = {637012.25, 4850000, -12.125}};
    std::vector<std::array<std::int32_t, 3>> numbers;
    for (int i = 0; i < 1000; ++i) numbers.push_back({i * 7919, 100000 - i * 31, i * i});
    numbers.push_back({2147483647, -2147483647 - 1, 0});  // as far apart as can be
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

TEST_CASE("the file's coordinates survive a way through PLY and text, bit by bit") {
  const std::string text = fileOf(3, 300).text();
  const StoredCloud stored = reading(text);
  for (const char* name : {"a.ply", "a.xyz"}) {
    const ScratchFolder folder;
    writeCloud(folder / name, stored.cloud);
    const PointCloud back = readCloud(folder / name).cloud;
    REQUIRE(back.size() == stored.cloud.size());
    for (std::size_t i = 0; i < back.size(); ++i) CHECK(back.fileCoordinates(i) == stored.cloud.fileCoordinates(i));
    CHECK(back.colors == stored.cloud.colors);
    CHECK(valueOf(back, "gps_time", 5) == valueOf(stored.cloud, "gps_time", 5));
    const PointCloud third = reading(written(back)).cloud;  // LAS once more, without what the first file said
    for (std::size_t i = 0; i < back.size(); ++i) CHECK(third.fileCoordinates(i) == stored.cloud.fileCoordinates(i));
    CHECK(pointsOf(written(back)) == pointsOf(text));
  }
}

TEST_CASE("colours of 16 bits that hold 8 become those, others lose no bit") {
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

TEST_CASE("extra bytes are attributes under their names, as they are described") {
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

  // Beyond what double precision counts.
  putAt(las.points, 28, (std::uint64_t{1} << 53) + 1);
  CHECK(reading(las.text()).lost == std::vector<std::string>{"whole numbers of 'big' beyond 2^53"});
}

TEST_CASE("records before and behind the points are carried, and named where they cannot be") {
  LasBytes las = fileOf(6, 30);
  las.records = lasRecord("LASF_Projection", 2112, "GEOGCS[...]") + lasRecord("somebody", 7, std::string(300, '\x7f'));
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
      "4 records of LAS: 'LASF_Projection' 2112, 'somebody' 7, 'LASF_Projection' 2112, 'late' 9";
  CHECK(lostOnTheWay(stored, cloudFormats().toWrite("a.ply")) == std::vector<std::string>{sentence});
  CHECK(lostOnTheWay(stored, cloudFormats().toWrite("a.las")).empty());

  // An attribute more moves what stands behind the points, and says so.
  PointCloud more = stored.cloud;
  more.extra.push_back({"quality", ScalarType::f32, std::vector<std::byte>(4 * more.size(), std::byte{1})});
  const std::string longer = written(more);
  const StoredCloud third = reading(longer);
  CHECK(namesOf(third.cloud).back() == "quality");
  CHECK(third.cloud.extra.back().data == more.extra.back().data);
  CHECK(longer.ends_with(las.tail));
  CHECK(third.cloud.storedAs.baggage->sentence == sentence);
}

TEST_CASE("what comes from other formats is written so that nothing changes, or said to") {
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
  attribute("intensity", [](int i) { return 0.5 + i; });  // no whole number, so none of LAS
  attribute("classification", [](int i) { return i % 3; });
  attribute("gps_time", [](int i) { return i * 1e-3; });
  cloud.storedAs.comments = {"comment units: mm"};
  markAsOurs(cloud);
  CHECK(lasFormat().lacks({.cloud = cloud}).empty());
  const PointCloud back = reading(written(cloud)).cloud;
  REQUIRE(back.size() == cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) CHECK(back.fileCoordinates(i) == cloud.fileCoordinates(i));
  CHECK(back.normals == cloud.normals);
  CHECK(back.colors == cloud.colors);
  CHECK(valueOf(back, "intensity_2", 3) == 3.5);
  CHECK(valueOf(back, "classification", 5) == 2);
  CHECK(valueOf(back, "gps_time", 5) == 5 * 1e-3);
  CHECK(isOurs(back.storedAs.comments));
  CHECK(std::ranges::find(back.storedAs.comments, "comment units: mm") != back.storedAs.comments.end());
  CHECK(std::ranges::find(back.storedAs.comments, "comment up: z") != back.storedAs.comments.end());

  StoredCloud rough{.cloud = {}, .triangles = {{0, 0, 0}}, .lost = {}};
  rough.cloud.positions = {{0.1f, 1e-9f, 0}, {1, 2, 3}};
  rough.cloud.storedAs.alpha = true;
  const std::vector<std::string> lost = lasFormat().lacks(rough);
  REQUIRE(lost.size() == 3);
  CHECK(lost[0] == "1 triangles");
  CHECK(lost[1] == "the alpha of colours");
  CHECK(lost[2].starts_with("coordinates finer than "));
  const PointCloud roughBack = reading(written(rough.cloud)).cloud;
  for (std::size_t i = 0; i < 2; ++i)
    CHECK(glm::length(roughBack.fileCoordinates(i) - rough.cloud.fileCoordinates(i)) < 3e-9);
  CHECK(reading(written({})).cloud.empty());
}

TEST_CASE("points that were moved are kept finer than the file was, and others as they were") {
  PointCloud cloud = reading(fileOf(0, 100).text()).cloud;
  const DVec3 still = cloud.fileCoordinates(41);
  cloud.positions[40] += Vec3(0.001f, -0.0004f, 0.0002f);  // steps are of 0.01
  const DVec3 moved = cloud.fileCoordinates(40);
  const PointCloud back = reading(written(cloud)).cloud;
  CHECK(back.fileCoordinates(41) == still);
  CHECK(glm::length(back.fileCoordinates(40) - moved) < 1e-6);
}

TEST_CASE("a class or a return that old formats cannot count makes it a newer one") {
  PointCloud cloud = reading(fileOf(1, 10).text()).cloud;
  for (Attribute& attribute : cloud.extra)
    if (attribute.name == "classification") attribute.data[3] = std::byte{64};
  const std::string text = written(cloud);
  CHECK(static_cast<int>(text[104]) == 6);
  CHECK(static_cast<int>(text[25]) == 4);
  const PointCloud back = reading(text).cloud;
  CHECK(valueOf(back, "classification", 3) == 64);
  CHECK(valueOf(back, "classification", 4) == 6);
  CHECK(valueOf(back, "scan_angle_rank", 4) == -12);  // which newer ones have otherwise
}

TEST_CASE("a file that is damaged or lies is refused with its byte") {
  const std::string good = fileOf(3, 10).text();
  const auto with = [&](std::size_t at, auto value) {
    std::string text = good;
    putAt(text, at, value);
    return refusal(text);
  };
  CHECK(refusal(good) == "read");
  CHECK(refusal("LAS is no format of mine").starts_with(": byte 0: not a LAS file"));
  CHECK(refusal("").starts_with(": byte 0: not a LAS file"));
  CHECK(refusal("LASF").starts_with(": byte 4: the file ends inside the header"));
  CHECK(refusal(good.substr(0, 226)).starts_with(": byte 226: the file ends inside the header"));
  CHECK(with(25, std::uint8_t{5}).starts_with(": byte 24: LAS version 1.5"));
  CHECK(with(24, std::uint8_t{2}).starts_with(": byte 24: LAS version 2.2"));
  CHECK(with(94, std::uint16_t{200}).starts_with(": byte 94: a header of 200 bytes"));
  CHECK(with(96, std::uint32_t{100}).starts_with(": byte 96: points at byte 100"));
  CHECK(with(96, std::uint32_t{4000000000}).find("the file ends before its points") != std::string::npos);
  CHECK(with(100, std::uint32_t{1}).starts_with(": byte 227: record 1 of 1 reaches into the points"));
  CHECK(with(104, std::uint8_t{131}).starts_with(": byte 104: the points are compressed (LAZ)"));
  CHECK(with(104, std::uint8_t{11}).starts_with(": byte 104: point format 11"));
  CHECK(with(105, std::uint16_t{33}).starts_with(": byte 105: points of 33 bytes"));
  CHECK(
      with(107, std::uint32_t{11}).starts_with(": byte 107: the header promises 11 points of 34 bytes, and 340 bytes"));
  CHECK(with(131, 0.0).starts_with(": byte 131: the scale of x is 0"));
  CHECK(with(139, std::nan("")).starts_with(": byte 139: the scale of y is nan"));
  CHECK(with(155, HUGE_VAL).starts_with(": byte 155: the offset of x is inf"));
  LasBytes las = fileOf(6, 3);
  las.tail = lasLongRecord("a", 1, "bcd");
  las.longRecords = 1;
  std::string behind = las.text();
  CHECK(refusal(behind) == "read");
  CHECK(refusal(behind.substr(0, behind.size() - 1)).find("record 1 of 1 behind the points is longer") !=
        std::string::npos);
  putAt(behind, 235, std::uint64_t{1} << 60);
  CHECK(refusal(behind).starts_with(": byte 235: records behind the points"));
  putAt(behind, 247, std::uint64_t{1} << 61);
  CHECK(refusal(behind).starts_with(": byte 247: the header promises"));
  LasBytes described{.minor = 4, .format = 0, .pointBytes = 21};
  described.records = lasRecord("LASF_Spec", 4, lasDescriptor("wide", 10));
  described.recordCount = 1;
  CHECK(refusal(described.text()).starts_with(": byte 375: describes more extra bytes than the 1"));
}

TEST_CASE("whatever is flipped, cut or made extreme in a file, it is read or refused") {
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
  REQUIRE(refusal(good) == "read");
  constexpr int kTries = 1500;
  const int read = readOfDamaged(good, ".las", 375 + 500, kTries);
  CHECK(read > 100);
  CHECK(read < kTries - 100);
}

TEST_CASE("files of laser scanners come out as their headers say") {
  const char* given = std::getenv("PALPATE_MODELS");
  const std::filesystem::path folder =
      std::filesystem::path(given ? given : PALPATE_SOURCE_DIR "/../shared/models") / "formats";
  if (!std::filesystem::exists(folder / "simple.las")) {
    MESSAGE("skipped: no ", (folder / "simple.las").string());
    return;
  }
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
    if (truth.sameHead) CHECK(back == text);  // the boxes of the others are not those of their points
  }
  const PointCloud simple = readCloud(folder / "simple.las").cloud;
  const Bounds box = boundsOf(simple);
  CHECK(glm::length(box.min + simple.origin - DVec3(635619.85, 848899.70, 406.59)) < 1e-2);
  CHECK(glm::length(box.max + simple.origin - DVec3(638982.55, 853535.43, 586.38)) < 1e-2);
  for (const char* name : {"simple.laz", "1_4_w_evlr.laz", "simple.copc.laz"})
    CHECK_THROWS_WITH_AS(readCloud(folder / name), doctest::Contains("compressed (LAZ)"), FileError);
}

}  // namespace palpate::test
