// A field of an edited cloud: as a file saved now would have it, and with all digits of 64 bits.
#include "engine/select/point_field.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "engine/cloud/edited_cloud.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::select_test {

namespace {

template <class T>
Attribute attributeOf(const char* name, ScalarType type, const std::vector<T>& values) {
  Attribute made{name, type, std::vector<std::byte>(values.size() * sizeof(T))};
  std::memcpy(made.data.data(), values.data(), made.data.size());
  return made;
}

constexpr std::uint64_t kFirst = 9007199254740993;  // a double does not hold it

/// Four points far from zero, with all kinds of fields.
PointCloud cloudOfFour() {
  PointCloud cloud;
  cloud.origin = {849000, 0, 0};
  for (int i = 0; i < 4; ++i) {
    cloud.positions.emplace_back(0.25f * static_cast<float>(i), 0, static_cast<float>(i * i));
    cloud.normals.emplace_back(0, 0, 1);
    cloud.colors.push_back({static_cast<std::uint8_t>(10 * i), 0, 0, 255});
  }
  cloud.storedAs.position = ScalarType::f64;
  cloud.extra = {attributeOf<std::uint8_t>("classification", ScalarType::u8, {2, 2, 5, 6}),
                 attributeOf<std::uint64_t>("id", ScalarType::u64, {kFirst, kFirst + 1, kFirst + 2, kFirst + 9}),
                 attributeOf<float>("heat", ScalarType::f32, {0.5f, std::nanf(""), 1.5f, 2.5f})};
  return cloud;
}

std::vector<double> shownOf(const PointField& field) {
  std::vector<double> absolute;
  for (const double number : field.numbers()) absolute.push_back(number + static_cast<double>(field.base()));
  return absolute;
}

}  // namespace

TEST_CASE(
    "numbers of a field are those of the file, of the states, or of the layer, and new points have their parents'") {
  const PointCloud cloud = cloudOfFour();
  std::vector<PointState> states = statesOf(cloud);
  states[1].position.x += 3;
  states[1].normal = {1, 0, 0};
  states[2].color = packedColor({77, 0, 0, 255});
  states.push_back(states[3]);
  states.back().number = 4, states.back().parent = 3;
  states.back().position.z = 20;
  states.push_back(states[4]);  // a child of a new point
  states.back().number = 5, states.back().parent = 4;
  const auto numbers = [&](const char* name, const std::vector<Field>& fields = {}) {
    PointField field("--color-by", name, cloud, fields, {.up = UpAxis::z});
    field.read(states, fields);
    return shownOf(field);
  };
  CHECK(numbers("x") == std::vector{849000.0, 849003.25, 849000.5, 849000.75, 849000.75, 849000.75});
  CHECK(numbers("z") == std::vector{0.0, 1.0, 4.0, 9.0, 20.0, 20.0});
  CHECK(numbers("nx") == std::vector{0.0, 1.0, 0.0, 0.0, 0.0, 0.0});
  CHECK(numbers("red") == std::vector{0.0, 10.0, 77.0, 30.0, 30.0, 30.0});
  CHECK(numbers("classification") == std::vector{2.0, 2.0, 5.0, 6.0, 6.0, 6.0});
  // What is computed stays as it was before the first edit.
  CHECK(numbers("height") == std::vector{0.0, 1.0, 4.0, 9.0, 9.0, 9.0});
  const std::vector<double> heat = numbers("heat");
  CHECK(std::isnan(heat[1]));
  CHECK(heat[5] == 2.5);
  // The layer's field stands before the file's, and shorter ones are 0 at the end.
  const std::vector<Field> layer{
      {.values = attributeOf<std::int16_t>("classification", ScalarType::i16, {-1, 9, 9}), .unit = "m"}};
  CHECK(numbers("classification", layer) == std::vector{-1.0, 9.0, 9.0, 0.0, 0.0, 0.0});
  const float infinite = std::numeric_limits<float>::infinity();
  const std::vector<Field> hot{
      {.values = attributeOf<float>("heat", ScalarType::f32, {infinite, -infinite, 3}), .unit = ""}};
  CHECK(std::isnan(numbers("heat", hot)[0]));
  CHECK(std::isnan(numbers("heat", hot)[1]));
  CHECK(numbers("heat", hot)[2] == 3);
  CHECK(PointField("--color-by", "classification", cloud, layer, {}).unit() == "m");
  CHECK(says(errorOf<UsageError>([&] { numbers("clasification"); }),
             "--color-by: unknown field 'clasification'; did you mean 'classification'?"));
}

TEST_CASE("points that change are followed one by one, to the same numbers as reading all") {
  const PointCloud cloud = cloudOfFour();
  for (const char* name : {"x", "ny", "red", "id", "heat", "roughness"}) {
    CAPTURE(name);
    std::vector<PointState> states = statesOf(cloud);
    PointField field("by", name, cloud, {}, {}), all("by", name, cloud, {}, {});
    field.read(states, {});
    states[2].position = {7, 8, 9};
    states[2].normal = {0, 1, 0};
    states[2].color = packedColor({200, 0, 0, 255});
    states.push_back(states[2]);
    states.back().number = 4, states.back().parent = 2;
    const std::vector<PointState> changed{states[2], states[4]};
    const auto followed = field.follow(changed, {});
    all.read(states, {});
    REQUIRE(field.numbers().size() == all.numbers().size());
    for (std::size_t i = 0; i < 5; ++i)
      CHECK(
          (field.numbers()[i] == all.numbers()[i] || (std::isnan(field.numbers()[i]) && std::isnan(all.numbers()[i]))));
    REQUIRE(followed.size() == 2);
    CHECK(followed[1].first == 4);
    if (name != std::string("roughness")) CHECK(followed[1].second == static_cast<float>(all.numbers()[4]));
  }
}

TEST_CASE("64-bit numbers are told apart, shown, typed and selected to the last digit") {
  const PointCloud cloud = cloudOfFour();
  const std::vector<PointState> states = statesOf(cloud);
  PointField field("by", "id", cloud, {}, {});
  field.read(states, {});
  CHECK(field.isWide());
  CHECK(std::vector(field.numbers().begin(), field.numbers().end()) == std::vector{0.0, 1.0, 2.0, 9.0});
  CHECK(field.text(1, 1) == "9007199254740994");
  CHECK(field.relative("9007199254740995") == 2.0);
  const std::vector<double> sorted{0, 1, 2, 9};
  const auto range = rangeIn("--color-range", "9007199254740994,9007199254740995", field, sorted);
  CHECK(range == std::pair{1.0, 2.0});
  const PointBits found = pointsInRange(field, shownPoints(states, {}), range);
  CHECK(found.count() == 2);
  CHECK(found.test(1));
  CHECK(field.text(1e19, 1) == "10009007199254740993");  // beyond 63 bits
  PointField x("by", "x", cloud, {}, {});
  x.read(states, {});
  CHECK(x.text(0.25, 0.001) == "849000.25");
  CHECK(x.text(0.25, 1) == "849000");
}

TEST_CASE("a range is numbers or percentiles, and others are refused with what is expected") {
  const PointCloud cloud = cloudOfFour();
  PointField field("by", "heat", cloud, {}, {});
  field.read(statesOf(cloud), {});
  const std::vector<double> sorted{0.5, 1.5, 2.5};
  CHECK(rangeIn("r", "0%,100%", field, sorted) == std::pair{0.5, 2.5});
  CHECK(rangeIn("r", "50%, 3", field, sorted) == std::pair{1.5, 3.0});
  CHECK(rangeIn("r", "-1e2,1e2", field, {}) == std::pair{-100.0, 100.0});
  CHECK(errorOf<UsageError>([&] { rangeIn("r", "3,1", field, sorted); }) ==
        "r: '3,1' begins above its end; write the lower number first");
  for (const char* reversed : {"3,1", "9%,2%"})
    CHECK(errorOf<UsageError>([&] { checkRange("r", reversed); }) ==
          fmt::format("r: '{}' begins above its end; write the lower number first", reversed));
  checkRange("r", "50%, 3");
  for (const char* wrong : {"", "5", "a,b", "1,2,3", "1%,101%", "nan,1", "1,inf", "%,5"})
    CHECK(errorOf<UsageError>([&] { checkRange("r", wrong); }) ==
          fmt::format("r: '{}' is not LOW,HIGH, as in 0,12.5 or 2%,98%", wrong));
  // A point without a number is in no range.
  CHECK(pointsInRange(field, shownPoints(statesOf(cloud), {}), {-1e9, 1e9}).count() == 3);
}

}  // namespace palpate::select_test
