#include <doctest/doctest.h>

#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/cloud/spacing.hpp"
#include "tests/labels.hpp"

namespace palpate::test::sculpture_test {

TEST_CASE("the sculpture is closed: the solid angle seen from any point is full or zero") {
  // Gauss: the flux of (q - p) / |q - p|^3 through a closed surface is 4 pi for p inside and 0 outside.
  const auto shape = makeShape("sculpture");
  const PointCloud cloud = sampleShape(*shape, {.count = 300'000});
  const double spacing = meanSpacing(cloud);
  int inside = 0, outside = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const SurfacePoint base = shape->closest(DVec3(cloud.positions[randomBits(1, i) % cloud.size()]));
    const DVec3 p = base.position + (i % 2 ? 4.0 : -4.0) * base.normal;
    const double distance = shape->signedDistance(p);
    if (std::abs(distance) < 2) continue;  // near another part
    double flux = 0, area = 0;
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      const DVec3 offset = DVec3(cloud.positions[k]) - p;
      const double squared = glm::dot(offset, offset);
      flux += glm::dot(offset, DVec3(cloud.normals[k])) / (squared * std::sqrt(squared));
      area += spacing * spacing;
    }
    const double turns = flux * area / static_cast<double>(cloud.size()) / (4 * std::numbers::pi);
    CHECK(std::abs(turns - (distance < 0 ? 1.0 : 0.0)) < 0.06);
    ++(distance < 0 ? inside : outside);
  }
  CHECK(inside > 10);
  CHECK(outside > 10);
}

TEST_CASE("the sculpture does not touch itself" * kMoreInFull) {
  // Walking inwards along the normal by less than the tube's radius stays inside, and walking outwards stays outside:
  // were two parts to overlap, some point of one would lie inside the other.
  const auto shape = makeShape("sculpture");
  const AreaMap map = shape->areaMap(0);
  for (std::uint64_t i = 0; i < byTier<std::uint64_t>(1500, 4000); ++i) {
    const SurfacePoint on = map({randomUnit(5, i), randomUnit(6, i)});
    CHECK(std::abs(shape->signedDistance(on.position + 0.05 * on.normal) - 0.05) < 1e-3);
    CHECK(std::abs(shape->signedDistance(on.position - 0.05 * on.normal) + 0.05) < 1e-3);
  }
}

TEST_CASE("parts of the sculpture that are far along the knot are far apart in space") {
  const PointCloud cloud = sampleShape(*makeShape("sculpture"), {.count = 60'000});
  // Points come in order along the knot, so index distance around the ring of indices is distance along it.
  const PointTree tree(cloud.positions);
  std::array<std::uint32_t, 48> indices{};
  std::array<double, 48> squared{};
  const auto count = static_cast<std::ptrdiff_t>(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); i += 3) {
    const std::size_t found = tree.nearest(cloud.positions[i], indices, squared);
    for (std::size_t k = 0; k < found; ++k) {
      const std::ptrdiff_t apart = std::abs(static_cast<std::ptrdiff_t>(i) - static_cast<std::ptrdiff_t>(indices[k]));
      const double share = static_cast<double>(std::min(apart, count - apart)) / static_cast<double>(count);
      REQUIRE(share < 0.05);
    }
  }
}

}  // namespace palpate::test::sculpture_test
