// Expressions: values, conditions, exactness, NaN and errors, against values that were worked out by hand.
#include "engine/select/expression.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "engine/core/job_stop.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"

namespace palpate::expression_test {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using Limits = std::numeric_limits<std::int64_t>;

template <class T>
Attribute attributeOf(const char* name, ScalarType type, const std::vector<T>& values) {
  Attribute made{name, type, {}};
  made.data.resize(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(made.data.data(), values.data(), made.data.size());
  return made;
}

// Five points, at x 0, 1, 2, 3, 4, y 0.5 less than that times -2, z 0.1.
PointCloud fivePoints() {
  PointCloud cloud;
  for (int i = 0; i < 5; ++i) {
    cloud.positions.emplace_back(i, -2 * i + 0.5f, 0.1f);
    cloud.colors.push_back({static_cast<std::uint8_t>(50 * i), 7, 255, 255});
  }
  cloud.extra.push_back(attributeOf<double>("heat", ScalarType::f64, {1.5, kNaN, -3, 0, 1e300}));
  cloud.extra.push_back(attributeOf<std::uint8_t>("classification", ScalarType::u8, {2, 2, 6, 0, 255}));
  cloud.extra.push_back(attributeOf<std::int64_t>(
      "id", ScalarType::i64, {9007199254740992, 9007199254740993, -9007199254740993, Limits::max(), Limits::min()}));
  cloud.extra.push_back(attributeOf<std::uint64_t>(
      "stamp", ScalarType::u64, {0, 18446744073709551615u, 18446744073709551614u, 9223372036854775808u, 1}));
  cloud.extra.push_back(attributeOf<float>("gps time", ScalarType::f32, {0.1f, 0.2f, 0.3f, kNaN, -0.0f}));
  return cloud;
}

std::string chosen(const PointCloud& cloud, std::string_view condition) {
  CloudFields fields(cloud);
  const PointSet set = pointsWhere("--where", condition, fields);
  std::string text;
  for (std::size_t i = 0; i < cloud.size(); ++i) text += set.test(i) ? '1' : '0';
  return text;
}

std::string complaint(std::string_view condition) {
  return errorOf<ExpressionError>([&] { chosen(fivePoints(), condition); });
}

}  // namespace

TEST_CASE("a condition holds for the points for which it is true") {
  const PointCloud cloud = fivePoints();
  struct {
    const char *condition, *points;
  } constexpr kCases[]{
      {"x > 1", "00111"},
      {"1<x", "00111"},
      {"x >= 1 && x <= 3", "01110"},
      {"x < 1 || x > 3", "10001"},
      {"x < 1 | x > 3 & classification == 2", "10000"},
      {"!(x < 1) & !(x > 3)", "01110"},
      {"x == 1 || x == 2 && heat > 0", "01000"},  // && before ||
      {"(x == 1 || x == 2) && heat < 0", "00100"},
      {"x != 2", "11011"},
      {"y < -3", "00111"},
      {"2 + 3 * x == 8", "00100"},
      {"(2 + 3) * x == 10", "00100"},
      {"x - 1 - 1 == 0", "00100"},  // from the left
      {"8 / 2 / 2 == x", "00100"},
      {"-x < -2", "00011"},
      {"--x == 3", "00010"},
      {"x % 2 == 1", "01010"},
      {"(x - 3) % 2 == 1", "10101"},  // the sign of the divisor
      {"x % 0 == 0", "00000"},
      {"abs(y) < 2", "11000"},
      {"sqrt(x) == 2", "00001"},
      {"floor(x / 2) == 1", "00110"},
      {"min(x, 2) == 2", "00111"},
      {"max(x, min(3, 2)) == 2", "11100"},
      {"red == 100 && green == 7 && blue == 255", "00100"},
      {"classification == 2", "11000"},
      {"classification == 255", "00001"},
      {"heat > -1e301", "10111"},
      {"heat == heat", "10111"},
      {"heat != 7", "10111"},  // NaN is in no comparison
      {"!(heat != 7)", "01000"},
      {"min(heat, 0) <= 0", "10111"},
      {"max(0, heat) >= 0", "10111"},
      {"z == 0.1", "11111"},  // as the file has it, in float32
      {"0.1 == z && z <= 0.1 && z >= 0.1", "11111"},
      {"\"gps time\" == 0.3", "00100"},
      {"'gps time' < 0.2", "10001"},
      {"height == y || height == x || height == z", "11111"},
      {"1.5e0 < x && .5 < x", "00111"},
  };
  for (const auto& each : kCases) {
    CAPTURE(each.condition);
    CHECK(chosen(cloud, each.condition) == each.points);
  }
}

TEST_CASE("whole numbers of 64 bits are compared to the last digit") {
  const PointCloud cloud = fivePoints();
  struct {
    const char *condition, *points;
  } constexpr kCases[]{
      {"id == 9007199254740992", "10000"},
      {"id == 9007199254740993", "01000"},
      {"id > 9007199254740992", "01010"},
      {"9007199254740992 < id", "01010"},
      {"id == -9007199254740993", "00100"},
      {"id >= 9223372036854775807", "00010"},
      {"id == -9223372036854775808", "00001"},
      {"id < -9223372036854775807", "00001"},
      {"id < 9223372036854775808", "11111"},
      {"stamp == 18446744073709551615", "01000"},
      {"stamp > 18446744073709551614", "01000"},
      {"stamp < 18446744073709551615", "10111"},
      {"stamp == 9223372036854775808", "00010"},
      {"id == 9007199254740992 + 1", "01000"},
      {"id - 9007199254740992 == 1", "01000"},
      {"id + stamp == 27670116110564327422", "00000"},
      {"id - stamp == -18446744073709551615 + 9007199254740993", "01000"},
      {"id * 2 == 18014398509481986", "01000"},
      {"id % 10 == 3", "01000"},
      {"id % 10 == 7", "00110"},  // -9007199254740993 and 9223372036854775807
      {"abs(id) == 9223372036854775808", "00001"},
      {"-id == 9223372036854775808", "00001"},
      {"max(id, stamp) == 9223372036854775808", "00010"},
      {"id > 9.5e15 && id > 2.5", "00010"},
      {"id / 2 > 4e18", "00010"},
      {"stamp == 1e0", "00001"},
  };
  for (const auto& each : kCases) {
    CAPTURE(each.condition);
    CHECK(chosen(cloud, each.condition) == each.points);
  }
  CloudFields fields(cloud);
  CHECK(errorOf([&] { pointsWhere("--where", "id * id * id > 0", fields); }).find("beyond 128 bits") !=
        std::string::npos);
}

TEST_CASE("an error names the column, what was expected and the fields") {
  const std::string fields =
      "x, y, z, red, green, blue, heat, classification, id, stamp, gps time, height, density, "
      "roughness, curvature, verticality";
  CHECK(complaint("z >") == "--where: column 4: a value is expected after '>'; fields: " + fields);
  CHECK(complaint("") == "--where: column 1: a value is expected; fields: " + fields);
  CHECK(complaint("z > )") == "--where: column 5: a value is expected after '>', not ')'; fields: " + fields);
  struct {
    const char *condition, *start;
  } constexpr kCases[]{
      {"clasification == 2", "--where: column 1: unknown field 'clasification'; did you mean 'classification'?"},
      {"z > 1 && w < 2", "--where: column 10: unknown field 'w'"},
      {"z", "--where: column 1: a condition is expected, and this is a number"},
      {"z && x > 1", "--where: column 1: '&&' is of conditions"},
      {"x > 1 && z", "--where: column 10: '&&' is of conditions"},
      {"1 < z < 3", "--where: column 1: '<' is of numbers, and this is a condition; conditions are joined as in"},
      {"(z > 1) + 1 > 2", "--where: column 1: '+' is of numbers"},
      {"!z > 3", "--where: column 1: '!' is of a condition; write it in parentheses"},
      {"z = 3", "--where: column 3: '=' does not compare; equality is =="},
      {"(z > 3", "--where: column 7: ')' is expected for the '(' in column 1"},
      {"z > 3)", "--where: column 6: ')' is not expected after '3'"},
      {"z > 3 4", "--where: column 7: '4' is not expected after '3'"},
      {"z > 1e999", "--where: column 5: '1e999' is not a number"},
      {"sin(z) > 0", "--where: column 1: unknown function 'sin'"},
      {"min(z) > 0", "--where: column 6: ',' is expected: min is of 2 numbers"},
      {"abs(z, 1) > 0", "--where: column 6: ')' is expected after the number of abs"},
      {"abs(z > 1) > 0", "--where: column 7: ')' is expected after the number of abs"},
      {"\"gps > 0", "--where: column 1: the name that begins with \" has no end"},
      {"z > #", "--where: column 5: a value is expected after '>', not '#'"},
      {"\u00e4\u00f6 > 1", "--where: column 1: unknown field '\u00e4\u00f6'"},
      {"'\u00e4' > 1 && ", "--where: column 1: unknown field '\u00e4'"},
      {"x > 1 && '\u00e4\u00f6' == y || b", "--where: column 10: unknown field"},
  };
  for (const auto& each : kCases) {
    CAPTURE(each.condition);
    const std::string found = complaint(each.condition);
    CHECK_MESSAGE(found.starts_with(each.start), found);
  }
}

TEST_CASE("a hostile expression ends in a sentence") {
  constexpr std::size_t kMany = 100'000;
  const auto nested = [](std::size_t count, const char* open, const char* close) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += open;
    text += "z > 1";
    for (std::size_t i = 0; i < count; ++i) text += close;
    return text;
  };
  for (const char* open : {"(", "!(", "-", "+(", "abs(", "!"}) {
    CAPTURE(open);
    CHECK(complaint(nested(10'000, open, "")).find("are within each other") != std::string::npos);
    CHECK(complaint(nested(kMany, open, "")).find("longer than 100000 characters") != std::string::npos);
  }
  CHECK(complaint(std::string(kMany, '(')).find("more than 200 parentheses and signs are within each other") !=
        std::string::npos);
  CHECK(chosen(fivePoints(), nested(190, "(", ")")) == "00000");
  // Long ones are accepted.
  std::string sum = "0";
  for (int i = 0; i < 20'000; ++i) sum += "+x+1";
  CHECK(chosen(fivePoints(), sum + " == 60000") == "00100");
  std::string stairs = "x";
  for (int i = 0; i < 180; ++i) stairs = "(x+" + stairs + ")";
  CHECK(chosen(fivePoints(), stairs + " == 543") == "00010");
}

TEST_CASE("clouds of all sizes, and results that are empty or full") {
  for (const std::size_t count : {0u, 1u, 63u, 64u, 65u, 255u, 256u, 257u, 4095u, 4096u, 4097u, 16384u, 40001u}) {
    PointCloud cloud;
    for (std::size_t i = 0; i < count; ++i) cloud.positions.emplace_back(static_cast<float>(i), 0, 0);
    for (const unsigned threads : {1u, 3u}) {
      CAPTURE(count);
      CloudFields fields(cloud, {.up = UpAxis::z, .threads = threads});
      const PointSet even = pointsWhere("--where", "x % 2 == 0", fields);
      CHECK(even.count() == (count + 1) / 2);
      bool same = true;
      for (std::size_t i = 0; i < count; ++i) same = same && even.test(i) == (i % 2 == 0);
      CHECK(same);
      CHECK(pointsWhere("--where", "x < 0", fields) == PointSet());
      CHECK(pointsWhere("--where", "x >= 0", fields) == PointSet::range(0, count));
      CHECK(valuesOf("field", "x * x - x", fields).size() == count);
    }
  }
}

TEST_CASE("coordinates are those of the file, far from zero and on its grid") {
  PointCloud cloud;
  cloud.origin = {637000, 849000, 0};
  cloud.storedAs.grid = CoordinateGrid{.step = DVec3(0.01), .offset = DVec3(0)};
  for (int i = 0; i < 400; ++i) cloud.positions.emplace_back(0.01 * i, 393.95, 0.01 * i);
  CHECK(chosen(cloud, "y == 849393.95") == std::string(400, '1'));
  CHECK(chosen(cloud, "x == 637001.23").find('1') == 123);
  CloudFields fields(cloud);
  CHECK(pointsWhere("--where", "x >= 637001.23 && x <= 637002.34", fields).count() == 112);
  CHECK(valuesOf("field", "x + 0", fields)[123] == 637001.23);

  PointCloud doubles;
  doubles.storedAs.position = ScalarType::f64;
  doubles.origin = {4e6, 0, 0};
  doubles.exactPositions = {{4000000.123456789, 0, 0}, {4000000.123456788, 0, 0}};
  for (const DVec3& each : doubles.exactPositions) doubles.positions.emplace_back(each - doubles.origin);
  CHECK(chosen(doubles, "x == 4000000.123456789") == "10");
}

TEST_CASE("a request to stop ends an evaluation") {
  PointCloud cloud;
  cloud.positions.resize(100'000);
  CloudFields fields(cloud);
  const std::atomic<bool> stop = true;
  const JobStopScope scope({.flag = &stop, .mayCut = true});
  CHECK_THROWS_AS(pointsWhere("--where", "x > 0", fields), Stopped);
}

}  // namespace palpate::expression_test
