// The one pass over a scan: fields that are computed, rules that set fields, the order of the steps, and what stays.
#include "engine/select/prepared_cloud.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/up.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/field_rule.hpp"
#include "engine/select/field_statistics.hpp"
#include "engine/select/move_points.hpp"
#include "engine/select/normal_signs.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"

namespace palpate::preparation_test {

namespace {

// A square plate of `side` points a side, `spacing` apart, in z = 0.
PointCloud grid(int side, float spacing) {
  PointCloud cloud;
  for (int i = 0; i < side; ++i)
    for (int k = 0; k < side; ++k)
      cloud.positions.emplace_back(spacing * static_cast<float>(i), spacing * static_cast<float>(k), 0);
  return cloud;
}

double middleOf(const std::vector<double>& values) {
  std::vector<double> sorted;
  for (const double value : values)
    if (!std::isnan(value)) sorted.push_back(value);
  std::ranges::sort(sorted);
  REQUIRE(!sorted.empty());
  return sorted[sorted.size() / 2];
}

double fieldMiddle(const PointCloud& cloud, const char* field, const FieldOptions& options = {}) {
  CloudFields fields(cloud, options);
  return middleOf(valuesOf("field", field, fields));
}

template <class T>
std::vector<T> valuesIn(const PointCloud& cloud, const std::string& name) {
  for (const Attribute& each : cloud.extra) {
    if (each.name != name) continue;
    std::vector<T> values(cloud.size());
    REQUIRE(each.data.size() == cloud.size() * sizeof(T));
    std::memcpy(values.data(), each.data.data(), each.data.size());
    return values;
  }
  FAIL("there is no ", name);
  return {};
}

std::string ruleError(PointCloud cloud, const char* rule) {
  return errorOf([&] { applyRule("--set", rule, cloud, {}); });
}

}  // namespace

TEST_CASE("computed fields have their known values, in mm, on plates, spheres and noise") {
  const PointCloud sphere = sampleShape(*makeShape("sphere", 20), {.count = 20'000});
  // 20 units across are 40 mm: a radius of 20 mm.
  const FieldOptions twice{.mm_per_unit = 2, .up = UpAxis::z};
  CHECK(fieldMiddle(sphere, "curvature", twice) == near(1 / 20.0, 0.02));
  PointCloud inward = sphere;
  flipNormals(inward);
  CHECK(fieldMiddle(inward, "curvature", twice) == near(-1 / 20.0, 0.02));
  CHECK(fieldMiddle(sphere, "density", twice) == near(20'000 / (4 * std::numbers::pi * 400), 0.05));
  PointCloud bare = sphere;
  bare.normals.clear();
  CHECK(std::abs(fieldMiddle(bare, "curvature", twice)) == near(1 / 20.0, 0.03));
  // The sum of the squared distances of a cap of a sphere from its mean plane.
  const PointCloud plate = grid(60, 0.5f);
  CHECK(fieldMiddle(plate, "roughness", {.up = UpAxis::z}) == within(0, 1e-9));
  CHECK(fieldMiddle(plate, "verticality", {.up = UpAxis::z}) == within(0, 1e-9));
  CHECK(fieldMiddle(plate, "verticality", {.up = UpAxis::x}) == near(1, 1e-9));
  CHECK(fieldMiddle(plate, "density", {.mm_per_unit = 10, .up = UpAxis::z}) == near(1 / 25.0, 0.1));
  PointCloud noisy = plate;
  for (std::size_t i = 0; i < noisy.size(); ++i) noisy.positions[i].z = static_cast<float>(0.1 * randomNormal3(1, i).z);
  CHECK(fieldMiddle(noisy, "roughness", {.mm_per_unit = 3, .up = UpAxis::z}) == near(0.29, 0.05));
  CHECK(fieldMiddle(plate, "height", {.up = UpAxis::minusX}) == within(-15, 0.6));
  // The other face of a thin plate is another surface, which faces away.
  PointCloud faces = plate;
  faces.normals.assign(faces.size(), Vec3(0, 0, 1));
  for (const Vec3& p : plate.positions) {
    faces.positions.push_back(p - Vec3(0, 0, 0.4f));
    faces.normals.emplace_back(0, 0, -1);
  }
  CHECK(fieldMiddle(faces, "curvature", {.radius = 2}) == within(0, 1e-6));
  // Without neighbourhoods nothing is known, and nothing is chosen.
  PointCloud equal;
  equal.positions.assign(5, Vec3(1));
  CloudFields fields(equal);
  for (const char* field : {"density > -1", "roughness > -1", "curvature < 9e9", "verticality >= 0"})
    CHECK(pointsWhere("--where", field, fields).empty());
  const PointCloud none;
  CloudFields noFields(none);
  CHECK(pointsWhere("--where", "curvature > 0 || density > 0 || verticality > 0", noFields).empty());
}

TEST_CASE("an attribute of the file hides a computed field of its name") {
  PointCloud cloud = grid(5, 1);
  applyRule("--set", "uint8 density = 7", cloud, {});
  CHECK(fieldMiddle(cloud, "density") == 7);
}

TEST_CASE("a rule sets a field where its condition holds, in the field's type") {
  PointCloud cloud = grid(10, 1);
  CHECK(applyRule("--set", "uint8 label = 3 if x > 4", cloud, {}).set == 50);
  CHECK(applyRule("--set", "label = label + x if y == 0", cloud, {}).set == 10);
  auto labels = valuesIn<std::uint8_t>(cloud, "label");
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    CHECK(labels[i] == (p.x > 4 ? 3 : 0) + (p.y == 0 ? static_cast<int>(p.x) : 0));
  }
  CHECK(applyRule("--set", "half = x / 2 if x >= 1", cloud, {}).set == 90);
  const auto halves = valuesIn<double>(cloud, "half");
  CHECK(std::isnan(halves[0]));
  CHECK(halves[95] == 4.5);
  CHECK(applyRule("--set", "\"my name\"=1e300*x", cloud, {}).set == 100);
  CHECK(applyRule("--set", "float32 'single' = 0.1", cloud, {}).set == 100);
  CHECK(valuesIn<float>(cloud, "single")[3] == 0.1f);
  CHECK(applyRule("--set", "int64 id = 9007199254740992", cloud, {}).set == 100);
  CHECK(applyRule("--set", "id = id + 1 if x == 2", cloud, {}).set == 10);
  CHECK(valuesIn<std::int64_t>(cloud, "id")[20] == 9007199254740993);
  CHECK(applyRule("--set", "other = id", cloud, {}).set == 100);
  CHECK(valuesIn<std::int64_t>(cloud, "other")[20] == 9007199254740993);
  CHECK(applyRule("--set", "uint64 big = 18446744073709551615", cloud, {}).set == 100);
  CHECK(valuesIn<std::uint64_t>(cloud, "big")[0] == 18446744073709551615u);
  CHECK(applyRule("--set", "red = 255 if x < 1", cloud, {}).set == 10);
  CHECK(cloud.colors[0][0] == 255);
  CHECK(cloud.colors[0][1] == cloud.colors[50][1]);
  CHECK(applyRule("--set", "label = 2.5", cloud, {}).set == 100);  // to the even number
  CHECK(valuesIn<std::uint8_t>(cloud, "label")[0] == 2);
  CHECK(applyRule("--set", "height = height if z > 99", cloud, {}).set == 0);
  CHECK(std::isnan(valuesIn<double>(cloud, "height")[0]));
  PointCloud none;
  CHECK(applyRule("--set", "a = 1", none, {}).set == 0);
}

TEST_CASE("a rule that cannot be applied names why, and changes nothing") {
  PointCloud cloud = grid(4, 1);
  applyRule("--set", "uint8 label = 3", cloud, {});
  struct {
    const char *rule, *start;
  } constexpr kCases[]{
      {"label = 300", "--set: label = 300 of point 0 is not a whole number from 0 to 255"},
      {"label = x - 1", "--set: label = -1 of point 0 is not a whole number from 0 to 255"},
      {"label = 1 / (x - 2) if x > 1", "--set: label = inf of point 8 is not a whole number"},
      {"label = sqrt(1 - x)", "--set: label = nan of point 8 is not a whole number"},
      {"int16 label = 1", "--set: label is of the type uchar in the file"},
      {"int64 a = 9223372036854775808", "--set: a = 9.223372036854776e+18 of point 0 is not a whole number"},
      {"uint64 a = -1", "--set: a = -1 of point 0 is not a whole number"},
      {"uint64 a = 2.0 * 9223372036854775808.5", "--set: a = 1.8446744073709552e+19 of point 0"},
      {"nx = 1", "--set: nx cannot be set; normals are estimated"},
      {"float32 x = 1", "--set: x has a type of its own"},
      {"x = 1 / 0", "--set: x = inf of point 0 is not a coordinate"},
      {"red = 256", "--set: red = 256 of point 0 is not a whole number from 0 to 255"},
      {"label", "--set: column 6: a rule has the form"},
      {"label == 3", "--set: column 7: a rule has the form"},
      {"= 3", "--set: column 1: a rule has the form"},
      {"big label = 3", "--set: column 1: 'big' is not a type"},
      {"label = ", "--set: column 9: a value is expected"},
      {"label = 3 if", "--set: column 13: a value is expected"},
      {"label = 3 if x", "--set: column 14: a condition is expected"},
      {"label = 3 for x > 1", "--set: column 11: 'for' is not expected after '3'"},
      {"label = x > 1", "--set: column 11: a number is expected, not a comparison '>'"},
      {"label = wax", "--set: column 9: unknown field 'wax'"},
      {"label = 3 if x > 1 if", "--set: column 20: 'if' is not expected"},
  };
  for (const auto& each : kCases) {
    CAPTURE(each.rule);
    const std::string found = ruleError(cloud, each.rule);
    CHECK_MESSAGE(found.starts_with(each.start), found);
  }
  CHECK(errorOf([&] { applyRule("--set", "label = 100 * x", cloud, {}); }) ==
        "--set: label = 300 of point 12 is not a whole number from 0 to 255");
  CHECK(valuesIn<std::uint8_t>(cloud, "label") == std::vector<std::uint8_t>(16, 3));
  CHECK(cloud.colors.empty());
}

TEST_CASE("moved points keep those that are not moved bit by bit, in doubles and on a grid") {
  PointCloud doubles;
  doubles.storedAs.position = ScalarType::f64;
  doubles.origin = {4e6, 0, 0};
  doubles.exactPositions = {{4000000.123456789, 1e-9, 0.3}, {4000000.123456788, 0, 5}};
  for (const DVec3& each : doubles.exactPositions) doubles.positions.emplace_back(each - doubles.origin);
  CHECK(applyRule("--set", "z = z - 12.5 if z > 1", doubles, {}).set == 1);
  CHECK(doubles.fileCoordinates(0) == DVec3(4000000.123456789, 1e-9, 0.3));
  CHECK(doubles.fileCoordinates(1) == DVec3(4000000.123456788, 0, -7.5));

  PointCloud cloud;
  cloud.origin = {637000, 849000, 0};
  cloud.storedAs.grid = CoordinateGrid{.step = DVec3(0.001), .offset = DVec3(0)};
  for (int i = 0; i < 400; ++i) cloud.positions.emplace_back(0.001 * i, 393.951, 0.5);
  const PointCloud before = cloud;
  applyRule("--set", "z = 9 if x > 637000.2", cloud, {});
  for (std::size_t i = 0; i <= 200; ++i) CHECK(cloud.fileCoordinates(i) == before.fileCoordinates(i));
  CHECK(cloud.fileCoordinates(201) == DVec3(before.fileCoordinates(201).x, before.fileCoordinates(201).y, 9));
  applyRule("--set", "z = z - 0.123", cloud, {});  // 9 - 0.123 and 0.5 - 0.123 are rounded; the grid has their decimals
  CHECK(cloud.fileCoordinates(201).z == 8877 * 0.001);
  CHECK(cloud.fileCoordinates(7).z == 377 * 0.001);
  // Only the sign of zero is the same in both.
  PointCloud singles = grid(3, 0.1f);
  const PointCloud single = singles;
  applyRule("--set", "x = x + 1 if y > 0.15", singles, {});
  for (std::size_t i = 0; i < 9; ++i)
    CHECK(singles.positions[i] == single.positions[i] + Vec3(single.positions[i].y > 0.15f ? 1 : 0, 0, 0));
  CHECK(singles.exactPositions.empty());
}

TEST_CASE("the ground is found under what stands on it, at any angle, and becomes level") {
  for (const double tilt_deg : {0.0, 7.0, 25.0}) {
    const double tilt = tilt_deg * std::numbers::pi / 180;
    const DVec3 normal(std::sin(tilt), 0, std::cos(tilt)), along(std::cos(tilt), 0, -std::sin(tilt)), across(0, 1, 0);
    PointCloud cloud;
    const DVec3 place(500, 20, 3);
    for (std::uint64_t i = 0; i < 40'000; ++i) {
      const DVec3 noise = 0.002 * randomNormal3(3, i);
      const auto draw = [&](std::uint64_t k) { return randomUnit(9, 3 * i + k); };
      const bool box = i % 3 == 0;  // walls and a top of a block on the ground
      const double u = box ? 3 + 2 * draw(0) : 10 * draw(0), v = box ? 3 + 2 * draw(1) : 10 * draw(1);
      double h = 0;
      if (box) h = i % 2 == 0 ? 2 : 2 * draw(2);
      cloud.positions.emplace_back(place + u * along + v * across + (h + noise.z) * normal);
      cloud.normals.emplace_back(normal);
    }
    cloud.storedAs.comments = {"comment up: z"};
    const auto ground = findGround(cloud);
    REQUIRE(ground);
    CHECK(angleBetween_deg(ground->normal, normal) < 0.05);
    const PreparedCloud level = prepared(cloud, {.level = true}, {});
    REQUIRE(level.cloud.size() == cloud.size());
    CHECK(level.steps.size() == 1);
    CHECK(level.cloud.storedAs.comments == std::vector<std::string>{"comment up: z"});
    CHECK(angleBetween_deg(DVec3(level.cloud.normals[7]), DVec3(0, 0, 1)) < 0.05);
    // Distances stay, and so does the handedness.
    const auto at = [](const PointCloud& of, std::size_t i) { return of.fileCoordinates(i); };
    const auto volume = [&](const PointCloud& of) {
      return glm::dot(glm::cross(at(of, 1) - at(of, 0), at(of, 2) - at(of, 0)), at(of, 3) - at(of, 0));
    };
    CHECK(glm::distance(at(level.cloud, 0), at(level.cloud, 30'000)) ==
          near(glm::distance(at(cloud, 0), at(cloud, 30'000)), 1e-4));
    CHECK(volume(level.cloud) == near(volume(cloud), 0.01));
  }
  // y up becomes z up, and upside down is turned over.
  for (const DVec3& up : {DVec3(0, 1, 0), DVec3(0, 0, -1), DVec3(1, 0, 0)}) {
    PointCloud cloud = grid(20, 1);
    cloud.normals.assign(cloud.size(), Vec3(up));
    rotateToZ(cloud, up);
    CHECK(angleBetween_deg(DVec3(cloud.normals[5]), DVec3(0, 0, 1)) < 1e-5);
  }
  PointCloud ball = sampleShape(*makeShape("sphere", 20), {.count = 5000});
  CHECK_FALSE(findGround(ball, UpAxis::z));
  CHECK(errorOf([&] { prepared(ball, {.level = true}, {}); }).starts_with("prepare.level: no ground was found"));
  CHECK_FALSE(findGround({}, UpAxis::z));
}

TEST_CASE("normals are oriented as their neighbours are, and flipped, bit by bit") {
  PointCloud cloud = sampleShape(*makeShape("sphere", 20), {.count = 3000});
  cloud.positions.push_back(cloud.positions[5]);
  cloud.normals.push_back(-cloud.normals[5]);
  const PointCloud before = cloud;
  for (std::size_t i = 0; i < cloud.size(); i += 2) cloud.normals[i] = -cloud.normals[i];
  orientNormals(cloud);
  for (std::size_t i = 0; i < 3000; ++i) CHECK(cloud.normals[i] == before.normals[i]);
  CHECK(cloud.normals[3000] == before.normals[5]);
  flipNormals(cloud);
  for (std::size_t i = 0; i < 3000; ++i) CHECK(cloud.normals[i] == -before.normals[i]);
  PointCloud bare = grid(3, 1);
  orientNormals(bare);
  flipNormals(bare);
  CHECK(bare.normals.empty());
}

TEST_CASE("steps are done in their order, and each says what it leaves") {
  PointCloud cloud = grid(10, 1);
  cloud.positions.push_back(cloud.positions[0]);
  const Preparation preparation{.crop = std::array{DVec3(5, 9, 9), DVec3(0, 0, -1)},  // in any order of its corners
                                .cropOutside = std::array{DVec3(0, 0, 0), DVec3(0, 0, 0)},
                                .where = "y < 9",
                                .dropDuplicates = true,
                                .subsample_mm = 20,
                                .random = 10,
                                .set = {"uint8 a = 1", "uint8 b = a + 1"}};
  std::vector<std::string> said;
  const PreparedCloud result = prepared(cloud, preparation, {.mm_per_unit = 10}, [&](const PreparedStep& step) {
    said.push_back(fmt::format("{} {}", step.name, step.what));
  });
  CHECK(said == std::vector<std::string>{
                    "prepare.crop keeps 61 of 101 points", "prepare.crop_outside keeps 59 of 61 points",
                    "prepare.where keeps 53 of 59 points", "prepare.drop_duplicates keeps 53 of 53 points",
                    "prepare.subsample_mm keeps 15 of 53 points", "prepare.random keeps 10 of 15 points",
                    "prepare.set \"uint8 a = 1\" sets 10 points", "prepare.set \"uint8 b = a + 1\" sets 10 points"});
  REQUIRE(result.numbers.size() == 10);
  for (std::size_t i = 0; i < 10; ++i) CHECK(result.cloud.positions[i] == cloud.positions[result.numbers[i]]);
  CHECK(valuesIn<std::uint8_t>(result.cloud, "b")[9] == 2);
  const PreparedCloud nothing = prepared(
      cloud,
      {.where = "x > 99", .outlierNeighbours = 8, .radiusNeighbours = 3, .subsample_mm = 1, .random = 5, .level = true},
      {});
  CHECK(nothing.cloud.empty());
  CHECK(prepared(cloud, {}, {}).cloud.positions == cloud.positions);
  CHECK(prepared(cloud, {.seed = 3}, {}).steps.empty());
}

TEST_CASE("statistical outliers report their share, and their progress up to the end") {
  PointCloud cloud = grid(80, 1);
  for (int i = 0; i < 40; ++i) cloud.positions.emplace_back(2 * i, 40, 30 + i % 7);
  std::mutex mutex;
  std::vector<double> shares;
  const FieldOptions options{.progress = [&](double share) {
    const std::scoped_lock hold(mutex);
    shares.push_back(share);
  }};
  const PreparedCloud few = prepared(cloud, {.outlierNeighbours = 8, .outlierSigma = 1}, options);
  CHECK(few.steps[0].what == "keeps 6396 of 6440 points, and drops 0.7 % of the points");
  REQUIRE(shares.size() >= 6440 / 1024);
  CHECK(shares.front() < 0.5);
  CHECK(shares.back() == 1);
  const PreparedCloud many = prepared(cloud, {.outlierNeighbours = 8, .outlierSigma = 0}, {});
  CHECK(many.steps[0].what.ends_with("% of the points; a larger sigma, such as 3, finds fewer"));
}

TEST_CASE("a part of a model keeps its up axis and its touch scale, and states them") {
  PointCloud cloud = grid(101, 1);  // 100 units: 1 mm in the hand for each
  for (int i = 0; i < 400; ++i) cloud.positions.emplace_back(50 + 0.01f * static_cast<float>(i), 50, 20);
  const Upright whole = findUp(cloud);
  const Corners part = std::array{DVec3(0, 0, -1), DVec3(10, 4, 30)};
  const PreparedCloud cropped = prepared(cloud, {.crop = part}, {});
  REQUIRE(cropped.upright);
  CHECK(cropped.upright->up == whole.up);
  CHECK(upSaidIn(cropped.cloud.storedAs.comments) == whole.up);
  CHECK(touchScaleSaidIn(cropped.cloud.storedAs.comments) == 1.0);
  CHECK(mmPerUnit(cropped.cloud, 0) == 1);
  CHECK(unitSaidIn(cropped.cloud.storedAs.comments) == LengthUnit::unknown);  // of which a touch scale says nothing
  // Again, and closer: it is still that of the first whole.
  CHECK(mmPerUnit(prepared(cropped.cloud, {.where = "x < 3"}, {}).cloud, 0) == 1);
  CHECK(prepared(cloud, {.where = "x >= 0"}, {}).cloud.storedAs.comments.empty());  // nothing was removed
  const PreparedCloud rotated = prepared(cloud, {.crop = part, .upright = UpAxis::x}, {});
  CHECK_FALSE(rotated.upright);
  CHECK(upSaidIn(rotated.cloud.storedAs.comments) == UpAxis::z);
  const PreparedCloud scaled = prepared(cloud, {.crop = part, .set = {"x = 1000 * x", "y = 1000 * y"}}, {});
  CHECK_FALSE(touchScaleSaidIn(scaled.cloud.storedAs.comments));  // of other units
  cloud.storedAs.comments = {"comment mm_per_unit: 3", "comment up: x"};
  CHECK(prepared(cloud, {.crop = part}, {}).cloud.storedAs.comments == cloud.storedAs.comments);
}

TEST_CASE("a rule says for how many points its number is not finite") {
  PointCloud cloud = grid(4, 1);
  CHECK(applyRule("--set", "share = y / x", cloud, {}).notFinite == 4);
  CHECK(applyRule("--set", "share = 1 / 0 if x == 1", cloud, {}).notFinite == 4);
  CHECK(applyRule("--set", "share = x", cloud, {}).notFinite == 0);
  std::string said;
  prepared(cloud, {.set = {"foo = 1 / 0"}}, {}, [&](const PreparedStep& step) { said = step.what; });
  CHECK(said == "\"foo = 1 / 0\" sets 16 points, 16 of them to inf or nan");
}

TEST_CASE("corners are read and written, and lengths in mm are those of the file") {
  CHECK(cornersIn("0,-1.5,2e3:4,5,6", "--crop") == Corners(std::array{DVec3(0, -1.5, 2000), DVec3(4, 5, 6)}));
  CHECK(cornersIn(cornersText(std::array{DVec3(0.1, 2, 3), DVec3(4, 5, 1e-9)}), "--crop") ==
        Corners(std::array{DVec3(0.1, 2, 3), DVec3(4, 5, 1e-9)}));
  for (const char* wrong : {"", "0,0,0", "0,0,0:1,1", "0,0,0:1,1,1,1", "0,0,0:1,1,x", "0,0,0;1,1,1", "0,0,0:1,1,inf",
                            "0,0,0:1,1,nan", "0 ,0,0:1,1,1"})
    CHECK(errorOf<UsageError>([&] { cornersIn(wrong, "--crop"); }) ==
          fmt::format("--crop: '{}' is not two corners of a box, as in 0,0,0:1.5,2,1", wrong));
  PointCloud cloud = grid(11, 1);
  CHECK(mmPerUnit(cloud, 0) == 10);  // 100 mm along the longest side
  CHECK(mmPerUnit(cloud, 7) == 7);
  cloud.storedAs.comments = {"comment units: m"};
  CHECK(mmPerUnit(cloud, 0) == 1000);
  cloud.storedAs.comments = {"comment units: m", "comment mm_per_unit: 3"};
  CHECK(mmPerUnit(cloud, 0) == 3);
}

TEST_CASE("statistics of a field are those of a table by hand") {
  const double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> values{4, 1, kNaN, 3, 2, 10};
  const FieldStatistics found = statisticsOf(values);
  CHECK(found.count == 5);
  CHECK(found.missing == 1);
  CHECK(found.min == 1);
  CHECK(found.max == 10);
  CHECK(found.mean == 4);
  CHECK(found.deviation == near(std::sqrt(12.5), 1e-12));
  CHECK(found.percentiles[2] == 2);
  CHECK(found.percentiles[3] == 3);
  CHECK(found.percentiles[5] == near(8.8, 1e-12));
  CHECK(found.histogram[0] == 1);
  CHECK(found.histogram[19] == 1);
  std::uint64_t all = 0;
  for (const std::uint64_t bin : found.histogram) all += bin;
  CHECK(all == 5);
  CHECK(statisticsOf({}).count == 0);
  const std::vector<double> none{kNaN}, one{7.5}, far{1e15, 1e15 + 1, 1e15 + 2};
  CHECK(statisticsOf(none).missing == 1);
  CHECK(statisticsOf(one).deviation == 0);
  CHECK(statisticsOf(one).histogram[0] == 1);
  CHECK(statisticsOf(far).deviation == 1);
}

}  // namespace palpate::preparation_test
