#include "engine/cloud/file_coordinates.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "tests/near.hpp"

namespace palpate::file_coordinates_test {

TEST_CASE("the bounding box of a cloud far from zero has the digits of its file") {
  PointCloud cloud;
  cloud.origin = {637000, 4877000, 0};
  const std::vector<DVec3> places{{637177.98, 4877754.178, 421.33}, {637200.01, 4877800.5, 400.07}};
  for (const DVec3& place : places) cloud.positions.emplace_back(place - cloud.origin);
  CHECK_FALSE(isExact(cloud));
  CHECK(fileBoundsOf(cloud).min.y != 4877754.178);  // float32 alone does not hold it
  PointCloud exact = cloud;
  exact.exactPositions.assign(places.begin(), places.end());
  REQUIRE(isExact(exact));
  CHECK(fileBoundsOf(exact) == Bounds{{637177.98, 4877754.178, 400.07}, {637200.01, 4877800.5, 421.33}});
  PointCloud onGrid = cloud;
  onGrid.storedAs.grid = CoordinateGrid{.step = DVec3(0.25), .offset = DVec3(0.125)};
  onGrid.positions = {Vec3(DVec3(637177.125, 4877754.375, 421.125) - cloud.origin)};
  CHECK(fileBoundsOf(onGrid).min == DVec3(637177.125, 4877754.375, 421.125));
  CHECK(fileBoundsOf({}) == Bounds{});
}

namespace {

/// x of a point on the grid, as text has it.
double textOf(const CoordinateGrid& grid, double k) {
  const DVec3 place = grid.at(DVec3(k));
  PointCloud cloud;
  cloud.positions = {Vec3(0)};
  cloud.origin = place;
  cloud.exactPositions = {place};
  cloud.storedAs.grid = grid;
  return TextCoordinates(cloud).at(0).x;
}

}  // namespace

TEST_CASE("text has coordinates on a decimal grid with no more digits than the grid") {
  for (const auto& [step, offset] :
       {std::pair(0.01, 0.0), {0.001, 600000.0}, {0.00025, 849000.5}, {1e-7, -3.25}, {-0.01, 12.34}}) {
    const CoordinateGrid grid{.step = DVec3(step), .offset = DVec3(offset)};
    for (int k = 0; k < 100'000; ++k) {
      const double number = k * 849.0 + 7, value = textOf(grid, number);
      CAPTURE(number);
      REQUIRE(grid.nearest(DVec3(value)).x == number);
      REQUIRE(value == within(number * step + offset, 1e-9));
      const std::string text = fmt::format("{:.9f}", value), digits = text.substr(0, text.find_last_not_of('0') + 1);
      REQUIRE(fmt::format("{}", value).size() <= digits.size());
    }
  }
  const auto at = [](double step, double offset, double k) {
    return textOf({.step = DVec3(step), .offset = DVec3(offset)}, k);
  };
  CHECK(at(0.01, 0, 84939395) == 849393.95);
  CHECK(84939395 * 0.01 != 849393.95);
  // Binary steps, thirds and huge numbers stay as they are.
  CHECK(at(1.0 / 3, 0, 5) == 5 * (1.0 / 3));
  CHECK(at(std::exp2(-20), 0.5, 12345) == 12345 * std::exp2(-20) + 0.5);
  CHECK(at(1e20, 1e28, 3) == 3 * 1e20 + 1e28);
}

}  // namespace palpate::file_coordinates_test
