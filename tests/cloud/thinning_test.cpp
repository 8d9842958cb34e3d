#include "engine/cloud/thinning.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/cloud/analytic_shape.hpp"
#include "tests/near.hpp"

namespace palpate::test::thinning_test {
namespace {

std::size_t countBetween(const PointCloud& cloud, float low, float high) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cloud.positions, [&](const Vec3& p) { return p.x >= low && p.x < high; }));
}

}  // namespace

TEST_CASE("thinning reduces the density by the ratio from one end to the other, evenly in between") {
  const PointCloud even = sampleShape(*makeShape("plane"), {.count = 400'000});
  const PointCloud thinned = thinnedAlong(even, 10);
  const auto kept = [&](float low, float high) {
    return static_cast<double>(countBetween(thinned, low, high)) / static_cast<double>(countBetween(even, low, high));
  };
  CHECK(kept(-50, -48) == near(std::pow(10, -0.01), 0.02));
  CHECK(kept(-1, 1) == near(std::pow(10, -0.5), 0.05));
  CHECK(kept(48, 50) == near(std::pow(10, -0.99), 0.1));
  CHECK(static_cast<double>(thinned.size()) / static_cast<double>(even.size()) == near(shareThatStays(10), 0.01));
  CHECK(thinned.normals.size() == thinned.size());
}

TEST_CASE("a thinning ratio of one keeps every point, and the same seed keeps the same points") {
  const PointCloud even = sampleShape(*makeShape("sphere", 100, DVec3(1e6)), {.count = 1000});
  CHECK(thinnedAlong(even, 1).positions == even.positions);
  CHECK(thinnedAlong(even, 10).origin == even.origin);
  CHECK(thinnedAlong(even, 10, 3).positions == thinnedAlong(even, 10, 3).positions);
  CHECK(thinnedAlong(even, 10, 3).positions != thinnedAlong(even, 10, 4).positions);
  CHECK(thinnedAlong({}, 10).empty());
}

}  // namespace palpate::test::thinning_test
