#include "engine/cloud/file_coordinates.hpp"

#include <doctest/doctest.h>

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

}  // namespace palpate::file_coordinates_test
