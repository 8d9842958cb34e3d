// PointCloud2 without a network: written messages are read back, every valid layout of other programs is read, and
// inconsistent messages are refused.
#include "haptics/sharing/ros_points.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "engine/core/clock.hpp"
#include "haptics/sharing/network.hpp"
#include "tests/error_of.hpp"
#include "tests/says.hpp"

namespace palpate::ros_points_test {

namespace {

template <class T>
void append(std::vector<std::uint8_t>& to, T value, bool swaps = false) {
  auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
  if (swaps) std::ranges::reverse(bytes);
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// A message of points with x, y, z, and the memory that it refers to.
struct Message {
  Message(std::size_t points, RosField::Type type, bool isBigEndian = false) {
    const std::uint32_t size = type == RosField::f64 ? 8 : 4;
    fields = {{"x", 0, type}, {"y", size, type}, {"z", 2 * size, type}};
    says = {.height = 1,
            .width = static_cast<std::uint32_t>(points),
            .isBigEndian = isBigEndian,
            .pointStep = 3 * size,
            .rowStep = static_cast<std::uint32_t>(3 * size * points)};
    for (std::size_t i = 0; i < points; ++i)
      for (const double at : {0.5 * static_cast<double>(i), -1.0, 2.25}) {
        if (type == RosField::f64)
          append(data, at + 4e6, isBigEndian);
        else
          append(data, static_cast<float>(at), isBigEndian);
      }
  }
  TakenRosPoints take() {
    says.fields = fields;
    says.data = data;
    return takeRosPoints(says);
  }
  std::vector<RosField> fields;
  std::vector<std::uint8_t> data;
  RosPoints says;
};

}  // namespace

TEST_CASE("a published cloud is read back in metres, without removed points") {
  std::vector<PointState> points;
  for (std::uint32_t i = 0; i < 100; ++i)
    points.push_back(
        {.position = Vec3(i, 2.f * i, -3.f), .number = i, .normal = {0, 0.6f, 0.8f}, .color = 0xff332211u});
  points[7].gone = true;
  points[8].color = 0;
  const auto data = rosDataOf(points, DVec3(1000, 0, 0), 2);
  REQUIRE(data.size() == 99 * kRosPointStep);
  const TakenRosPoints taken = takeRosPoints({.height = 1,
                                              .width = 99,
                                              .fields = fieldsOfRosPoints(),
                                              .pointStep = kRosPointStep,
                                              .rowStep = 99 * kRosPointStep,
                                              .data = data});
  CHECK(taken.skipped == 0);
  REQUIRE(taken.cloud.size() == 99);
  CHECK(taken.cloud.positions[8] == Vec3(2.018f, 0.036f, -0.006f));
  CHECK(taken.cloud.normals[8] == Vec3(0, 0.6f, 0.8f));
  CHECK(taken.cloud.colors[8] == std::array<std::uint8_t, 4>{0x11, 0x22, 0x33, 255});
  CHECK(taken.cloud.colors[7] == kUnpainted);
  CHECK(taken.cloud.extra.empty());
  CHECK(taken.cloud.origin == DVec3(0));
}

TEST_CASE("single and double precision of either byte order are read, also far from zero") {
  for (const bool isBig : {false, true}) {
    CAPTURE(isBig);
    const PointCloud narrow = Message(5, RosField::f32, isBig).take().cloud;
    CHECK(narrow.positions[4] == Vec3(2, -1, 2.25f));
    CHECK_FALSE(narrow.hasNormals());
    CHECK_FALSE(narrow.hasColors());
    const PointCloud wide = Message(5, RosField::f64, isBig).take().cloud;
    CHECK(wide.fileCoordinates(4) == DVec3(4e6 + 2, 4e6 - 1, 4e6 + 2.25));
    CHECK(wide.origin.x > 3e6);
  }
}

TEST_CASE("rows with padding, gaps between fields and other number types are read") {
  Message message(0, RosField::f32);
  message.fields = {{"intensity", 2, RosField::u16}, {"z", 12, RosField::f32},    {"y", 8, RosField::f32},
                    {"x", 4, RosField::f32},         {"rgba", 16, RosField::u32}, {"bad name", 20, RosField::u8},
                    {"several", 20, RosField::u8, 4}};
  message.says = {.height = 2, .width = 2, .pointStep = 24, .rowStep = 53};
  for (std::uint16_t row = 0; row < 2; ++row) {
    for (std::uint16_t i = 0; i < 2; ++i) {
      append<std::uint16_t>(message.data, 0xdead);
      append<std::uint16_t>(message.data, static_cast<std::uint16_t>(10 * row + i));
      for (const float at : {1.f, 2.f, 3.f}) append(message.data, at + static_cast<float>(row));
      append<std::uint32_t>(message.data, 0x00010203);
      append<std::uint32_t>(message.data, 0);
    }
    if (row == 0) message.data.resize(message.data.size() + 5, 0xff);  // no padding after the last row
  }
  const PointCloud cloud = message.take().cloud;
  REQUIRE(cloud.size() == 4);
  CHECK(cloud.positions[3] == Vec3(2, 3, 4));
  CHECK(cloud.colors[0] == std::array<std::uint8_t, 4>{1, 2, 3, 255});
  REQUIRE(cloud.extra.size() == 1);
  CHECK(cloud.extra[0].name == "intensity");
  CHECK(cloud.extra[0].type == ScalarType::u16);
  std::array<std::uint16_t, 4> values{};
  REQUIRE(cloud.extra[0].data.size() == sizeof(values));
  std::memcpy(values.data(), cloud.extra[0].data.data(), sizeof(values));
  CHECK(values == std::array<std::uint16_t, 4>{0, 1, 10, 11});
}

TEST_CASE("points without a valid position are skipped and counted; invalid normals are dropped") {
  Message message(6, RosField::f32);
  const float nan = std::numeric_limits<float>::quiet_NaN(), far = 1e31f,
              infinite = std::numeric_limits<float>::infinity();
  std::memcpy(message.data.data() + 12, &nan, 4);
  std::memcpy(message.data.data() + 24 + 8, &far, 4);
  std::memcpy(message.data.data() + 36 + 4, &infinite, 4);
  const TakenRosPoints taken = message.take();
  CHECK(taken.skipped == 3);
  CHECK(taken.cloud.size() == 3);
  // If no normal has a length, the cloud has no normals.
  message.fields.insert(message.fields.end(), {{"normal_x", 0}, {"normal_y", 0}, {"normal_z", 0}});
  std::memset(message.data.data(), 0, message.data.size());
  CHECK_FALSE(message.take().cloud.hasNormals());
}

TEST_CASE("any number of empty rows is an empty cloud and takes no time") {
  Message message(0, RosField::f32);
  message.says.height = 0xffffffffu;
  const Stopwatch since;
  CHECK(message.take().cloud.empty());
  CHECK(since.elapsed_s() < 1);
  message.says.width = 5;
  message.says.height = 0;
  CHECK(message.take().cloud.empty());
}

TEST_CASE("a message that contradicts itself is refused with a reason, without allocating what it claims") {
  const auto spoiled = [](const std::function<void(Message&)>& spoil, const std::string& words) {
    CAPTURE(words);
    Message message(4, RosField::f32);
    spoil(message);
    CHECK(says(errorOf([&] { message.take(); }), words));
  };
  constexpr std::uint32_t kMax = 0xffffffffu;
  spoiled([](Message& m) { m.data.pop_back(); }, "48 bytes of points are announced, and 47 there");
  spoiled([](Message& m) { m.says.height = kMax; }, "bytes of points are announced");
  spoiled([](Message& m) { m.says.width = kMax; }, "a row of 4294967295 points");
  spoiled([](Message& m) { m.says.width = m.says.height = m.says.rowStep = m.says.pointStep = kMax; }, "a row of");
  spoiled([](Message& m) { m.says.width = 1, m.says.height = m.says.rowStep = m.says.pointStep = kMax; },
          "are announced");
  spoiled([](Message& m) { m.says.width = kMax, m.says.pointStep = 0, m.says.height = kMax; },
          "ends at byte 4 of points of 0");
  spoiled([](Message& m) { m.fields[2].offset = 9; }, "field 3 ends at byte 13 of points of 12");
  spoiled([](Message& m) { m.fields[2].offset = kMax; }, "field 3 ends at byte");
  spoiled([](Message& m) { m.fields[0].count = kMax; }, "field 1 ends at byte");
  spoiled([](Message& m) { m.fields[1].type = 0; }, "field 2 has type 0");
  spoiled([](Message& m) { m.fields[1].type = 9; }, "field 2 has type 9");
  spoiled([](Message& m) { m.fields.resize(257); }, "257 fields");
  spoiled([](Message& m) { m.fields.pop_back(); }, "without positions");
  spoiled([](Message& m) { m.fields[1].type = RosField::i32; }, "without positions");
  spoiled([](Message& m) { m.fields[1].count = 0; }, "without positions");
  spoiled(
      [](Message& m) {
        m.fields.clear();
        m.says.pointStep = m.says.rowStep = 0;
        m.says.width = m.says.height = kMax;
      },
      "without positions");
}

TEST_CASE("random bytes as a point message are read or refused") {
  std::mt19937 random(24);
  const auto any = [&](std::uint32_t most) { return static_cast<std::uint32_t>(random() % (most + 1ull)); };
  // Mostly near the right values, to get past the first check.
  const auto number = [&](std::uint32_t most) {
    return any(19) == 0 ? static_cast<std::uint32_t>(random()) : any(most);
  };
  constexpr std::array<const char*, 9> kNames{"x",        "y",   "z",    "normal_x", "normal_y",
                                              "normal_z", "rgb", "ring", "\x01\xff"};
  std::size_t read = 0, refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::uint8_t> data(any(3) == 0 ? any(200) : 600);
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
    std::vector<RosField> fields;
    const std::uint8_t type = any(1) ? RosField::f32 : RosField::f64;
    for (std::uint32_t i = 0, count = 2 + any(7); i < count; ++i)
      fields.push_back({.name = kNames[any(9) == 0 ? any(8) : i % kNames.size()],
                        .offset = number(16),
                        .type = any(19) == 0 ? static_cast<std::uint8_t>(random()) : type,
                        .count = any(19) == 0 ? number(4) : 1});
    const RosPoints points{.height = number(3),
                           .width = number(6),
                           .fields = fields,
                           .isBigEndian = any(1) == 1,
                           .pointStep = 24 + number(16),
                           .rowStep = 100 + number(100),
                           .data = data};
    try {
      const TakenRosPoints taken = takeRosPoints(points);
      ++read;
      const PointCloud& cloud = taken.cloud;
      const std::uint64_t all = std::uint64_t{points.width} * points.height;
      const auto fits = [&](const auto& array) { return array.empty() || array.size() == cloud.size(); };
      bool isRight = cloud.size() + taken.skipped == all && cloud.size() <= data.size() && fits(cloud.normals) &&
                     fits(cloud.colors);
      for (const Vec3& place : cloud.positions) isRight = isRight && isFinite(place);
      for (const Vec3& normal : cloud.normals) isRight = isRight && std::abs(glm::length(normal) - 1) < 1e-3;
      for (const Attribute& attribute : cloud.extra)
        isRight = isRight && attribute.data.size() == cloud.size() * sizeOf(attribute.type);
      REQUIRE_MESSAGE(isRight, "round " << round);
    } catch (const NetworkError&) {
      ++refused;
    }
  }
  CHECK(read > 1000);
  CHECK(refused > 1000);
}

}  // namespace palpate::ros_points_test
