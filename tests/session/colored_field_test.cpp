// Statistics, range and legend of the field that colours a picture, against numbers that are known.
#include "haptics/session/colored_field.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::colored_field_test {

namespace {

/// A row of points: z is 0 to 100, w is NaN at ten of them, classes are 2, 5 and 40.
PointCloud row() {
  PointCloud cloud;
  Attribute classes{"classification", ScalarType::u8, {}}, gaps{"w", ScalarType::f32, {}};
  for (int i = 0; i <= 100; ++i) {
    cloud.positions.emplace_back(0, 0, static_cast<float>(i));
    cloud.normals.emplace_back(0, 0, 1);
    classes.data.push_back(std::byte(i < 50 ? 2 : i < 90 ? 5 : 40));
    const float w = i < 10 ? std::nanf("") : static_cast<float>(i);
    gaps.data.resize(gaps.data.size() + sizeof w);
    std::memcpy(gaps.data.data() + gaps.data.size() - sizeof w, &w, sizeof w);
  }
  cloud.extra = {classes, gaps};
  return cloud;
}

ColoredField fieldOf(const PointCloud& cloud, const ColorConfig& config, const PointSet& hidden = {}) {
  ColoredField field(config, cloud, {}, {}, LengthUnit::m);
  const std::vector<PointState> states = statesOf(cloud);
  field.read(states, {}, shownPoints(states, hidden));
  return field;
}

}  // namespace

TEST_CASE("a range is the 2nd to the 98th percentile of the shown points, and counts them") {
  const PointCloud cloud = row();
  const ColorConfig config{.by = "z"};
  const ColoredField field = fieldOf(cloud, config);
  CHECK(field.range(config) == std::pair{2.0, 98.0});
  CHECK(field.countIn({2, 98}) == 97);
  CHECK(field.countIn({200, 300}) == 0);
  CHECK(field.statistics().mean == near(50, 1e-12));
  CHECK(field.statistics().deviation == near(29.300, 1e-4));
  CHECK(field.meanText() == "50");
  CHECK(field.heading() == "z, m");
  CHECK(field.missing() == 0);
  const ColoredField part = fieldOf(cloud, config, PointSet::range(51, 101));
  CHECK(part.statistics().max == 50);
  CHECK(part.range(config) == std::pair{1.0, 49.0});
  double bars = 0;
  for (const float count : field.histogram()) bars += static_cast<double>(count);
  CHECK(bars == 101);
  const FieldColors first = field.colors(config);
  CHECK(first.low == 2);
  CHECK(field.floats()[100] == 100);
  const ColoredField gaps = fieldOf(cloud, {.by = "w"});
  CHECK(gaps.missing() == 10);
  CHECK(gaps.statistics().count == 91);
  CHECK(gaps.legend({.by = "w"}).entries.back().text == "no number");
}

TEST_CASE("a legend has the ends of its range and round numbers, and for classes those that occur with their names") {
  const PointCloud cloud = row();
  const Legend legend = fieldOf(cloud, {.by = "z"}).legend({.by = "z", .range = "0.5,70"});
  REQUIRE(legend.marks.size() == 5);
  CHECK(legend.marks[0].text == "0.5");
  CHECK(legend.marks[1].text == "20");
  CHECK(legend.marks[1].share == near(19.5 / 69.5, 1e-9));
  CHECK(legend.marks[4].text == "70");
  CHECK(legend.marks[4].share == 1);
  CHECK(legend.entries.empty());
  // 60 would be written over 62.
  CHECK(fieldOf(cloud, {.by = "z"}).legend({.by = "z", .range = "0.5,62"}).marks.size() == 4);
  const ColorConfig classes{.by = "classification"};
  CHECK(classes.mapOf() == ColorMap::classes);
  const Legend found = fieldOf(cloud, classes).legend(classes);
  CHECK(found.marks.empty());
  REQUIRE(found.entries.size() == 3);
  CHECK(found.entries[0].text == "2 ground");
  CHECK(found.entries[1].text == "5 high vegetation");
  CHECK(found.entries[2].text == "40");
  CHECK(found.entries[0].color == shared::classColor(2));
  CHECK(fieldOf(cloud, classes).range(classes) == std::pair{2.0, 40.0});
  CHECK(fieldOf(cloud, classes).legend({.by = "classification", .map = ColorMap::grey}).marks.size() > 1);
  const Legend far = fieldOf(cloud, {.by = "z"}).legend({.by = "z", .map = ColorMap::classes});
  REQUIRE(far.entries.size() == 15);
  CHECK(far.entries.back().text == "further classes");
  CHECK(shared::classColor(3e9f) == shared::classColor(1e9f));
  const Legend heights = legendOf("height", LengthUnit::m, -1, 3, ColorMap::turbo);
  CHECK(heights.heading == "height, m");
  CHECK(heights.marks.front().text == "-1");
}

TEST_CASE("a field without a number, or with a single one, has a range and a legend") {
  PointCloud cloud = row();
  for (const float value : {std::nanf(""), 7.0f}) {
    CAPTURE(value);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      std::memcpy(cloud.extra[1].data.data() + i * sizeof value, &value, sizeof value);
    const ColoredField field = fieldOf(cloud, {.by = "w"});
    const double expected = std::isnan(value) ? 0 : 7;
    CHECK(field.range({.by = "w"}) == std::pair{expected, expected});
    CHECK(field.legend({.by = "w"}).marks.size() == 1);
    CHECK(field.histogram().size() == (std::isnan(value) ? 0 : 1));
    CHECK(field.countIn({7, 7}) == (std::isnan(value) ? 0 : 101));
  }
}

TEST_CASE("the numbers of a million points are counted") {
  PointCloud cloud;
  cloud.positions.resize(1'000'000);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.positions[i] = {static_cast<float>(i * 7919 % 100'003), 0, static_cast<float>(i % 977)};
  const std::vector<PointState> states = statesOf(cloud);
  const PointBits shown = shownPoints(states, {});
  const Stopwatch watch;
  ColoredField field({.by = "x"}, cloud, {}, {}, LengthUnit::unknown);
  field.read(states, {}, shown);
  const double read_ms = 1e-3 * watch.elapsed_us();
  const Stopwatch again;
  field.summarise(shown);
  MESSAGE("1,000,000 points: read and counted in ", read_ms, " ms, counted again in ", 1e-3 * again.elapsed_us(),
          " ms");
  CHECK(field.statistics().count == 1'000'000);
  CHECK(field.range({.by = "x"}).second == near(98'003, 0.001));
}

TEST_CASE("settings of colours that do not go together are refused before a model is read") {
  validate({.by = "anything", .range = "1%,99%"});
  CHECK(says(errorOf<UsageError>([] { validate({.by = "z", .range = "9"}); }), "--color-range: '9' is not LOW,HIGH"));
  CHECK(says(errorOf<UsageError>([] { validate({.by = "height", .map = ColorMap::classes}); }),
             "--color-map: classes are numbers of a field"));
}

}  // namespace palpate::colored_field_test
