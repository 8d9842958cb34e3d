#include "engine/study/surface_before.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "tests/near.hpp"

namespace palpate::test::surface_before_test {
namespace {

// A square grid that faces up.
PointCloud grid(int side, double spacing = 1, double height = 0, double up = 1) {
  PointCloud cloud;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      cloud.positions.emplace_back(spacing * (x - side / 2), spacing * (y - side / 2), height);
      cloud.normals.emplace_back(0, 0, up);
    }
  return cloud;
}

void add(PointCloud& cloud, const PointCloud& more) {
  cloud.positions.insert(cloud.positions.end(), more.positions.begin(), more.positions.end());
  cloud.normals.insert(cloud.normals.end(), more.normals.begin(), more.normals.end());
}

}  // namespace

TEST_CASE("the spacing at a position is that of its own sheet and density") {
  for (const double spacing : {0.1, 1.0, 20.0}) {
    const PointCloud even = grid(41, spacing);
    // Disc counts are between those of a lattice and of random points: 2.2 % wide here.
    CHECK(SurfaceBefore(even).spacingAt({0.3 * spacing, 0, 0}, {0, 0, 1}) / spacing == near(1.022, 0.002));
  }
  PointCloud plate = grid(41);
  add(plate, grid(41, 1, -0.8, -1));  // does not count as one denser sheet
  CHECK(SurfaceBefore(plate).spacingAt({0.3, 0, -0.4}, {0, 0, 1}) == near(1.022, 0.03));
  // Coincident points count once.
  PointCloud twice = grid(41);
  add(twice, grid(41));
  CHECK(SurfaceBefore(twice).spacingAt({0.3, 0, 0}, {0, 0, 1}) == near(1, 0.1));
}

TEST_CASE("height above a surface is exact on curves, on plates and at edges") {
  const PointCloud sphere = sampleShape(*makeShape("sphere", 100), {.count = 15'000});
  const SurfaceBefore onSphere(sphere);
  for (const double height : {-3.0, -0.5, 0.0, 0.2, 2.0, 6.0})
    for (const DVec3& d : {DVec3(0, 0, 1), DVec3(0.8, 0.6, 0), DVec3(-0.6, 0, 0.8)})
      CHECK(onSphere.heightAt((50 + height) * d) == within(height, 0.01));
  PointCloud plate = grid(61, 1, 0.4);
  add(plate, grid(61, 1, -0.4, -1));
  const SurfaceBefore onPlate(plate);
  for (const double z : {-3.0, -0.4, 0.0, 0.3, 0.9})
    CHECK(onPlate.heightAt({7.3, -11.1, z}) == within(std::abs(z) - 0.4, 0.01));
  const PointCloud cube = sampleShape(*makeShape("cube", 20), {.count = 2400});  // 1 apart
  const SurfaceBefore onCube(cube);
  CHECK(onCube.heightAt({9.99, 0, 9.99}) < 0.1);    // on the edge, where a round fit is too low
  CHECK(onCube.heightAt({12, 0.3, 10}) > 0.5);      // a fin that continues along a face
  CHECK(onCube.heightAt({10.7, 0.3, 10.7}) > 0.5);  // a fin beyond the edge
  CHECK(onCube.heightAt({0, 0, 0}) < -8);
}

TEST_CASE("the height of a noisy surface is that of its highest point nearby") {
  PointCloud cloud = grid(41);
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.positions[i].z = i % 3 == 0 ? 0.8F : -0.4F;
  const SurfaceBefore surface(cloud);
  CHECK(surface.heightAt({0.5, 0.5, 0.8}) < 0.2);
  CHECK(surface.heightAt({0.5, 0.5, 1.8}) == near(1, 0.2));
}

TEST_CASE("a normal is carried as its sheet is bent, and not by a motion that crushes the sheet") {
  // The part to the right of the centre is rolled up around a cylinder of radius 1, by three quarters of a turn.
  const PointCloud sheet = grid(61, 0.1);
  const SurfaceBefore surface(sheet);
  std::vector<PointState> states = statesOf(sheet);
  const auto angleOf = [](const Vec3& before) { return std::max(0.0, double{before.x}); };
  for (PointState& state : states)
    if (const double angle = angleOf(state.position); angle > 0)
      state.position = Vec3(std::sin(angle), state.position.y, 1 - std::cos(angle));
  for (std::uint32_t i = 0; i < sheet.size(); ++i) {
    const double angle = angleOf(sheet.positions[i]);
    const auto carried = carriedNormal(sheet, surface.tree(), states, i);
    REQUIRE(carried);
    // At the border and at the crease the neighbours are on one side.
    CHECK(glm::dot(*carried, DVec3(-std::sin(angle), 0, std::cos(angle))) > 0.97);
  }
  for (PointState& state : states) state.position.x *= 1e-3F;
  CHECK_FALSE(carriedNormal(sheet, surface.tree(), states, 30 * 61 + 10));
}

TEST_CASE("a normal tangential to its surface does not show which side is outside") {
  PointCloud cloud = grid(41);
  const PointTree tree(cloud.positions);
  const std::uint32_t point = 20 * 41 + 21;
  CHECK(tellsItsSide(cloud, tree, point));
  cloud.normals[point] = Vec3(1, 0, 0.1);
  CHECK_FALSE(tellsItsSide(cloud, tree, point));
}

}  // namespace palpate::test::surface_before_test
