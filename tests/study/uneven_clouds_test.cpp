#include "engine/study/uneven_clouds.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "engine/cloud/point_tree.hpp"
#include "engine/core/error.hpp"
#include "tests/near.hpp"

namespace palpate::test::uneven_clouds_test {
namespace {

std::size_t countWhere(const PointCloud& cloud, auto&& holds) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cloud.positions, [&](const Vec3& p) { return holds(DVec3(p)); }));
}

// Sorted distances of each point to its nearest neighbour.
std::vector<double> nearestDistances(const PointCloud& cloud) {
  const PointTree tree(cloud.positions);
  std::vector<double> distances;
  for (const Vec3& p : cloud.positions) {
    std::array<std::uint32_t, 2> points{};
    std::array<double, 2> squared{};
    tree.nearest(p, points, squared);
    distances.push_back(std::sqrt(squared[1]));
  }
  std::ranges::sort(distances);
  return distances;
}

}  // namespace

TEST_CASE("uneven clouds lie on their surfaces, with their normals and about the requested number of points") {
  for (const std::string_view name : unevenCloudNames()) {
    CAPTURE(name);
    const UnevenCloud uneven = makeUnevenCloud(name, 15'000);
    CHECK(static_cast<double>(uneven.cloud.size()) == near(15'000, 0.1));
    REQUIRE(uneven.cloud.normals.size() == uneven.cloud.size());
    double off = 0, turned = 0;
    for (std::size_t i = 0; i < uneven.cloud.size(); ++i) {
      const DVec3 p(uneven.cloud.positions[i]), n(uneven.cloud.normals[i]);
      off = std::max(off, std::abs(uneven.signedDistance(p)));
      turned = std::max(turned, std::abs(uneven.signedDistance(p + 0.1 * n) - 0.1));
    }
    CHECK(off < 1e-4);
    CHECK(turned < 1e-4);
    CHECK(std::abs(uneven.signedDistance(uneven.place)) < 1e-9);
    CHECK(std::abs(glm::dot(uneven.normal, uneven.towards)) < 1e-9);
    CHECK(makeUnevenCloud(name, 15'000).cloud.positions == uneven.cloud.positions);
  }
  CHECK_THROWS_AS(makeUnevenCloud("cheese", 100), UsageError);
}

TEST_CASE("the gradient cloud is ten times as dense at one end as at the other") {
  const PointCloud cloud = makeUnevenCloud("gradient", 100'000).cloud;
  // Bands of equal height have equal areas.
  const std::size_t dense = countWhere(cloud, [](const DVec3& p) { return p.x > 49; });
  const std::size_t sparse = countWhere(cloud, [](const DVec3& p) { return p.x < -49; });
  CHECK(static_cast<double>(dense) / static_cast<double>(sparse) == near(10, 0.05));
}

TEST_CASE("8 % of the points of the patches cloud lie between patches, and a border runs through the test position") {
  const UnevenCloud uneven = makeUnevenCloud("patches", 15'000);
  const std::vector<double> nearest = nearestDistances(uneven.cloud);
  const auto wide = static_cast<double>(std::ranges::count_if(nearest, [](double d) { return d > 2; }));
  const double share = wide / static_cast<double>(nearest.size());
  CHECK(share > 0.07);
  CHECK(share < 0.085);
  const auto near = [&](const DVec3& middle) {
    return countWhere(uneven.cloud, [&](const DVec3& p) { return glm::distance(p, middle) < 4; });
  };
  CHECK(near(uneven.place - 5.0 * uneven.towards) > 40);
  CHECK(near(uneven.place + 5.0 * uneven.towards) < 10);
}

TEST_CASE("random and decimated clouds have crowded points and holes, the even ones do not") {
  const std::vector<double> even = nearestDistances(makeUnevenCloud("even", 15'000).cloud);
  const std::vector<double> random = nearestDistances(makeUnevenCloud("random", 15'000).cloud);
  const std::vector<double> decimated = nearestDistances(makeUnevenCloud("decimated", 15'000).cloud);
  const auto ratio = [](const std::vector<double>& d) { return d[d.size() * 95 / 100] / d[d.size() * 5 / 100]; };
  CHECK(ratio(even) < 1.2);
  CHECK(ratio(random) > 4);
  CHECK(ratio(decimated) > 4);
}

TEST_CASE("the two sheets of a plate face away from each other") {
  const PointCloud plate = makePlate(2000, 0.8);
  CHECK(plate.size() == 2000);
  for (std::size_t i = 0; i < plate.size(); ++i) {
    REQUIRE(std::abs(plate.positions[i].z) == near(0.4, 1e-6));
    REQUIRE(plate.positions[i].z * plate.normals[i].z > 0);
  }
}

}  // namespace palpate::test::uneven_clouds_test
