#include "engine/core/tool_shape.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "engine/core/error.hpp"
#include "tests/near.hpp"

namespace palpate::tool_shape_test {

namespace {

constexpr std::array<ToolKind, 3> kManyPointed{ToolKind::pad, ToolKind::ball, ToolKind::spatula};

DVec3 balance(const ToolShape& tool) {
  DVec3 sum(0);
  for (const ToolPoint& point : tool.points) sum += point.share * point.place;
  return sum;
}

double leastDistance(const ToolShape& tool) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tool.points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, glm::distance(tool.points[i].place, tool.points[j].place));
  return least;
}

}  // namespace

TEST_CASE("a tool has the requested number of points, and their shares of the stiffness add up to one") {
  for (const ToolKind kind : kManyPointed)
    for (std::size_t count = 1; count <= kMaxToolPoints; ++count) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(count);
      const ToolShape tool = makeTool(kind, count, 10);
      REQUIRE(tool.points.size() == count);
      double shares = 0;
      for (const ToolPoint& point : tool.points) {
        CHECK(isFinite(point.place));
        CHECK(point.share > 0);
        shares += point.share;
      }
      CHECK(shares == near(1, 1e-12));
      // No two points much closer than in an even covering of the tool's area.
      if (count > 1) CHECK(leastDistance(tool) > 3.5 / std::sqrt(static_cast<double>(count)));
    }
}

TEST_CASE("a tool of one point is the HIP, for every kind of tool") {
  for (const auto& [name, kind] : kToolKinds) {
    const ToolShape tool = makeTool(kind, 1, 10);
    CHECK(tool.points[0].place == DVec3(0));
    CHECK(tool.points[0].share == 1);
  }
}

TEST_CASE("pads and spatulas are balanced on the HIP, face -z and have the requested size") {
  for (std::size_t count = 2; count <= kMaxToolPoints; ++count) {
    CAPTURE(count);
    const ToolShape pad = makeTool(ToolKind::pad, count, 10), spatula = makeTool(ToolKind::spatula, count, 10);
    CHECK(glm::length(DVec2(balance(pad))) < 1e-12);
    CHECK(glm::length(balance(spatula)) < 1e-12);
    double foremost = 10;
    for (const ToolPoint& point : pad.points) {
      CHECK(glm::length(DVec2(point.place)) < 5);
      CHECK(glm::distance(point.place, DVec3(0, 0, 10)) == near(10, 1e-6));  // radius of curvature = width
      CHECK(point.place.z < 5);
      foremost = std::min(foremost, point.place.z);
    }
    CHECK(foremost >= 0);
    if (count > 3) CHECK(foremost == 0);
    for (const ToolPoint& point : spatula.points) {
      CHECK(point.place.z == 0);
      CHECK(std::abs(point.place.x) < 2.5);
      CHECK(std::abs(point.place.y) < 5);
    }
  }
}

TEST_CASE("the points of a ball are spread evenly around the HIP") {
  for (const std::size_t count : {2u, 8u, 16u, 63u, 64u}) {
    CAPTURE(count);
    const ToolShape ball = makeTool(ToolKind::ball, count, 10);
    for (const ToolPoint& point : ball.points) CHECK(glm::length(point.place) == near(5, 1e-6));
    CHECK(glm::length(balance(ball)) < 5 / std::sqrt(static_cast<double>(count)) / 2);
  }
}

TEST_CASE("a tool keeps its shape when it is rotated to any direction") {
  const ToolShape pad = makeTool(ToolKind::pad, 16, 10);
  for (const DVec3 axis : {DVec3(0, 0, -3), DVec3(0, 0, 2), DVec3(1, 0, 0), DVec3(-1, 2, -2), DVec3(1e-9, 0, 1)}) {
    CAPTURE(axis.x);
    CAPTURE(axis.z);
    const ToolShape turned = facing(pad, axis);
    const DVec3 to = glm::normalize(axis);
    for (std::size_t i = 0; i < pad.points.size(); ++i) {
      CHECK(glm::dot(turned.points[i].place, to) == within(-pad.points[i].place.z, 1e-7));
      CHECK(glm::distance(turned.points[i].place, turned.points[3].place) ==
            within(glm::distance(pad.points[i].place, pad.points[3].place), 1e-9));
    }
  }
  CHECK(facing(pad, {0, 0, -3}).points[5].place == pad.points[5].place);
}

TEST_CASE("tools of invalid size, count or direction are refused with a reason") {
  CHECK_THROWS_WITH_AS(makeTool(ToolKind::pad, 0, 10), doctest::Contains("1 to 64"), UsageError);
  CHECK_THROWS_WITH_AS(makeTool(ToolKind::pad, 65, 10), doctest::Contains("1 to 64"), UsageError);
  CHECK_THROWS_AS(makeTool(ToolKind::point, 2, 10), UsageError);
  for (const double size :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_WITH_AS(makeTool(ToolKind::ball, 8, size), doctest::Contains("above zero"), UsageError);
  CHECK_THROWS_WITH_AS(facing(makeTool(ToolKind::pad, 8, 10), DVec3(0)), doctest::Contains("has no direction"),
                       UsageError);
}

TEST_CASE("unit quaternions are accepted as rotations, others are not") {
  const double half = std::sqrt(0.5);
  CHECK(isTurn({1, 0, 0, 0}));
  CHECK(isTurn({half, 0, half, 0}));
  CHECK(isTurn({0.70710, 0, 0, 0.70711}));  // with a device's rounding
  CHECK_FALSE(isTurn({0, 0, 0, 0}));
  CHECK_FALSE(isTurn({1, 0.1, 0, 0}));
  CHECK_FALSE(isTurn({std::numeric_limits<double>::quiet_NaN(), 0, 0, 0}));
}

}  // namespace palpate::tool_shape_test
