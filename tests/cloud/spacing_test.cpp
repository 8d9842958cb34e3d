#include "engine/cloud/spacing.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "tests/near.hpp"

namespace palpate::test::spacing_test {
namespace {

PointCloud randomSquare(std::size_t count) {
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i)
    cloud.positions.emplace_back(static_cast<float>(randomUnit(1, i)), static_cast<float>(randomUnit(2, i)), 0.0f);
  return cloud;
}

}  // namespace

TEST_CASE("the spacing is the root of the area per point") {
  const PointCloud sphere = sampleShape(*makeShape("sphere"), {.count = 200'000});
  CHECK(meanSpacing(sphere) == near(0.396, 0.03));
  const PointCloud plane = sampleShape(*makeShape("plane", 1), {.count = 10'000});
  CHECK(meanSpacing(plane) == near(0.01, 0.03));
  CHECK(meanSpacing(randomSquare(40'000)) == near(0.005, 0.03));
}

TEST_CASE("the wide spacing is that of the sparsest region") {
  const SpacingRange even = spacingRange(sampleShape(*makeShape("sphere"), {.count = 50'000}));
  CHECK(even.wide < 1.1 * even.mean);
  PointCloud cloud = randomSquare(40'000);
  const PointCloud sparse = randomSquare(4'000);
  for (const Vec3& place : sparse.positions) cloud.positions.push_back(place + Vec3(5, 0, 0));
  const SpacingRange range = spacingRange(cloud);
  CHECK(range.mean == near(0.005, 0.05));
  CHECK(range.wide > 0.0158);
  CHECK(range.wide < 0.024);
}

TEST_CASE("neither one distant point nor duplicates change the spacing") {
  PointCloud cloud = sampleShape(*makeShape("sphere"), {.count = 50'000});
  const double spacing = meanSpacing(cloud);
  cloud.positions.emplace_back(1e9f, 0.0f, 0.0f);
  CHECK(meanSpacing(cloud) == near(spacing, 0.01));
  const std::vector<Vec3> once = cloud.positions;
  for (int copy = 0; copy < 3; ++copy) cloud.positions.insert(cloud.positions.end(), once.begin(), once.end());
  CHECK(meanSpacing(cloud) == near(spacing, 0.01));
}

TEST_CASE("the spacing of a cloud of millions is measured on a sample") {
  const PointCloud cloud = sampleShape(*makeShape("torus"), {.count = 2'500'000});
  const double area = 4 * std::numbers::pi * std::numbers::pi * 35 * 15;
  CHECK(meanSpacing(cloud) == near(std::sqrt(area / 2.5e6), 0.04));
}

TEST_CASE("a cloud without two different positions has no spacing") {
  PointCloud cloud;
  CHECK(meanSpacing(cloud) == 0);
  cloud.positions = {Vec3(1)};
  CHECK(meanSpacing(cloud) == 0);
  cloud.positions.assign(10'000, Vec3(1, 2, 3));
  CHECK(meanSpacing(cloud) == 0);
  cloud.positions = {Vec3(0), Vec3(1, 0, 0)};
  CHECK(meanSpacing(cloud) > 0);
}

TEST_CASE("the spacing does not depend on the number of threads") {
  const PointCloud cloud = randomSquare(20'000);
  CHECK(meanSpacing(cloud, 1) == meanSpacing(cloud, 5));
}

}  // namespace palpate::test::spacing_test
