// The nearest points of the k-d tree, of one position and of many in turn, compared with all distances.
#include "engine/cloud/point_tree.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "tests/random_positions.hpp"

namespace palpate::test::point_tree_test {

namespace {

/// The points in the order of their distances, then of their indices.
std::vector<std::uint32_t> byDistance(std::span<const Vec3> points, const Vec3& p) {
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  const auto squared = [&](std::uint32_t i) {
    const DVec3 d = DVec3(points[i]) - DVec3(p);
    return d.x * d.x + d.y * d.y + d.z * d.z;
  };
  std::ranges::stable_sort(all, {}, squared);
  return all;
}

/// Many equal distances.
std::vector<Vec3> lattice() {
  std::vector<Vec3> points;
  for (int i = 0; i < 1000; ++i) points.emplace_back(i % 10, i / 10 % 10, i / 100);
  return points;
}

/// A leaf of the tree that is far wider than the distances in it.
std::vector<Vec3> clustersAndOutliers() {
  std::vector<Vec3> points = randomPositions(1500, Vec3(0), 0.01f);
  for (const Vec3& each : randomPositions(40, Vec3(0), 50)) points.push_back(each);
  for (const Vec3& each : randomPositions(400, Vec3(30), 1e-4f)) points.push_back(each);
  return points;
}

}  // namespace

TEST_CASE("the nearest points are those of all distances, and of equal ones those of lower index") {
  for (const auto& points : {randomPositions(2000, Vec3(0), 1), lattice(), clustersAndOutliers(),
                             randomPositions(5, Vec3(0), 1), std::vector<Vec3>{Vec3(1)}, std::vector<Vec3>{}}) {
    const PointTree tree(points);
    NearbySearch search(tree);
    std::vector<std::uint32_t> asked(tree.order().begin(), tree.order().end());
    for (std::uint32_t i = 0; i < points.size(); i += 7) asked.push_back(i);  // far from the one before
    for (const std::size_t most : {1u, 9u, 16u, 64u}) {
      CAPTURE(points.size());
      CAPTURE(most);
      std::vector<std::uint32_t> one(most), many(most);
      std::vector<double> squared(most), squaredOfMany(most);
      for (std::size_t n = 0; n < asked.size(); n += 3) {
        const Vec3 at = points[asked[n]] + (n % 2 ? Vec3(1e-3f, 0, 0) : Vec3(0));
        const std::size_t found = tree.nearest(at, one, squared);
        REQUIRE(found == std::min(most, points.size()));
        REQUIRE(search.nearest(at, many, squaredOfMany) == found);
        REQUIRE(one == many);
        REQUIRE(squared == squaredOfMany);
        const std::vector<std::uint32_t> truth = byDistance(points, at);
        REQUIRE(std::equal(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(found), truth.begin()));
      }
    }
  }
}

TEST_CASE("a tree does not depend on the number of threads") {
  const auto points = randomPositions(20000, Vec3(0), 1);
  const PointTree one(points, 1), three(points, 3);
  CHECK(std::ranges::equal(one.order(), three.order()));
}

}  // namespace palpate::test::point_tree_test
