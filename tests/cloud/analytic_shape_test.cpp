#include "engine/cloud/analytic_shape.hpp"

#include <doctest/doctest.h>

#include <numbers>
#include <string>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/parametric_shape.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/error.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"

namespace palpate::test::analytic_shape_test {

namespace {

DVec3 numericalGradient(const AnalyticShape& shape, const DVec3& p, double step) {
  DVec3 gradient;
  for (int k = 0; k < 3; ++k) {
    DVec3 shift(0);
    shift[k] = step;
    gradient[k] = (shape.signedDistance(p + shift) - shape.signedDistance(p - shift)) / (2 * step);
  }
  return gradient;
}

bool sameBytes(const PointCloud& a, const PointCloud& b) {
  return a.positions == b.positions && a.normals == b.normals;
}

}  // namespace

TEST_CASE("every shape gives exactly the requested number of points, on its surface and with its normals") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(std::string(name));
    const auto shape = makeShape(name);
    for (const std::size_t count : {0u, 1u, 2u, 255u, 1000u}) {
      const PointCloud cloud = sampleShape(*shape, {.count = count});
      CHECK(cloud.size() == count);
      CHECK(cloud.normals.size() == count);
      CHECK(cloud.origin == DVec3(0));
      for (std::size_t i = 0; i < count; ++i) {
        const SurfacePoint truth = shape->closest(DVec3(cloud.positions[i]));
        CHECK(glm::distance(truth.position, DVec3(cloud.positions[i])) < 1e-5);  // float32 at 50
        CHECK(std::abs(glm::length(cloud.normals[i]) - 1) < 1e-6f);
        if (name != "cube") CHECK(glm::dot(truth.normal, DVec3(cloud.normals[i])) > 1 - 1e-6);
      }
    }
  }
}

TEST_CASE("the longest side of a shape is its size, and the middle is its centre") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(std::string(name));
    const DVec3 center(3, -4, 5);
    const auto shape = makeShape(name, 20, center);
    const Bounds box = boundsOf(sampleShape(*shape, {.count = 100'000}));
    CHECK(box.longestSide() <= 20.00001);
    CHECK(box.longestSide() > 19.98);
    CHECK(glm::distance(box.center(), center) < 0.05);
  }
}

TEST_CASE("the signed distance is positive outside and its gradient is the normal") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(std::string(name));
    const auto shape = makeShape(name, 100, DVec3(1, 2, 3));
    const AreaMap map = shape->areaMap(1);
    for (std::uint64_t i = 0; i < 100; ++i) {
      const SurfacePoint on = map({randomUnit(1, i), randomUnit(2, i)});
      CHECK(std::abs(shape->signedDistance(on.position)) < 1e-9);
      const double offset = 0.02;  // below every radius of curvature
      CHECK(shape->signedDistance(on.position + offset * on.normal) == near(offset, 1e-6));
      CHECK(shape->signedDistance(on.position - offset * on.normal) == near(-offset, 1e-6));
      const SurfacePoint back = shape->closest(on.position + offset * on.normal);
      CHECK(glm::distance(back.position, on.position) < 1e-5 * 0.1);
      CHECK(glm::dot(back.normal, on.normal) > 1 - 1e-9);
      CHECK(glm::distance(numericalGradient(*shape, on.position + offset * on.normal, 1e-4), on.normal) < 1e-4);
    }
  }
}

TEST_CASE("the closest point is as close as any sample") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(std::string(name));
    const auto shape = makeShape(name);
    const PointCloud cloud = sampleShape(*shape, {.count = 100'000});
    const PointTree tree(cloud.positions);
    for (std::uint64_t i = 0; i < 300; ++i) {
      const double reach = i % 3 == 0 ? 40.0 : 0.7;
      const DVec3 p = DVec3(cloud.positions[randomBits(3, i) % cloud.size()]) + reach * randomNormal3(4, i);
      std::uint32_t nearest = 0;
      double squared = 0;
      tree.nearest(Vec3(p), {&nearest, 1}, {&squared, 1});
      CHECK(std::abs(shape->signedDistance(p)) <= std::sqrt(squared) + 1e-5);
    }
  }
}

TEST_CASE("shapes with closed forms have their known distances and nearest points") {
  CHECK(makeShape("sphere")->signedDistance({0, 0, 60}) == near(10, 1e-6));
  CHECK(makeShape("sphere")->signedDistance({0, 0, 0}) == near(-50, 1e-6));
  CHECK(makeShape("torus")->signedDistance({0, 0, 0}) == near(20, 1e-6));
  CHECK(makeShape("torus")->signedDistance({0, 35, 5}) == near(-10, 1e-6));
  CHECK(makeShape("cube")->signedDistance({53, 54, 0}) == near(5, 1e-6));
  CHECK(makeShape("cube")->signedDistance({0, 40, 0}) == near(-10, 1e-6));
  CHECK(makeShape("plane")->signedDistance({7, 8, -9}) == near(-9, 1e-6));
  CHECK(makeShape("plane")->closest({70, 8, 9}).position == DVec3(50, 8, 0));
  const DVec3 corner = makeShape("cube")->closest({51, 51, 51}).normal;
  CHECK(glm::distance(corner, DVec3(1 / std::sqrt(3.0))) < 1e-12);
}

TEST_CASE("points of a shape are spread evenly") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(std::string(name));
    const PointCloud cloud = sampleShape(*makeShape(name), {.count = 50'000});
    const double spacing = meanSpacing(cloud);
    const PointTree tree(cloud.positions);
    std::vector<double> nearest;
    for (std::size_t i = 0; i < cloud.size(); i += 7) {
      std::array<std::uint32_t, 2> indices{};
      std::array<double, 2> squared{};
      tree.nearest(cloud.positions[i], indices, squared);
      nearest.push_back(std::sqrt(squared[1]) / spacing);
    }
    std::sort(nearest.begin(), nearest.end());
    // A hexagonal lattice has 1.07 throughout; random points have a hundredth below 0.06 and reach 1.9.
    CHECK(nearest[nearest.size() / 100] > (name == "sculpture" ? 0.3 : 0.6));
    CHECK(nearest.back() < 1.35);
  }
}

TEST_CASE("the same seed gives the same points bit by bit with any number of threads, another seed others") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(std::string(name));
    const auto shape = makeShape(name);
    const PointCloud cloud = sampleShape(*shape, {.count = 5'000, .seed = 5, .noise = 0.3, .threads = 1});
    // A shape that was never sampled with fewer points.
    CHECK(sameBytes(cloud, sampleShape(*makeShape(name), {.count = 5'000, .seed = 5, .noise = 0.3, .threads = 7})));
    CHECK(sameBytes(cloud, sampleShape(*shape, {.count = 5'000, .seed = 5, .noise = 0.3, .threads = 3})));
    CHECK_FALSE(sameBytes(cloud, sampleShape(*shape, {.count = 5'000, .seed = 6, .noise = 0.3})));
    CHECK_FALSE(
        sameBytes(sampleShape(*shape, {.count = 100, .seed = 5}), sampleShape(*shape, {.count = 100, .seed = 6})));
  }
}

TEST_CASE("noise has the requested deviation and leaves the normals true") {
  const auto shape = makeShape("plane");
  const PointCloud clean = sampleShape(*shape, {.count = 50'000});
  const PointCloud noisy = sampleShape(*shape, {.count = 50'000, .noise = 0.25});
  CHECK(noisy.normals == clean.normals);
  for (int k = 0; k < 3; ++k) {
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      const double shift = noisy.positions[i][k] - clean.positions[i][k];
      sum += shift;
      squares += shift * shift;
    }
    CHECK(std::abs(sum / 50'000) < 0.005);
    CHECK(std::sqrt(squares / 50'000) == near(0.25, 0.02));
  }
}

TEST_CASE("a far centre moves the origin without loss of precision") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(std::string(name));
    const DVec3 center(1e6, -2e6, 3e6);
    const auto shape = makeShape(name, 100, center);
    const PointCloud cloud = sampleShape(*shape, {.count = 500});
    CHECK(glm::distance(cloud.origin, center) < 100);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      CHECK(std::abs(shape->signedDistance(cloud.fileCoordinates(i))) < 2e-5);
  }
}

TEST_CASE("an invalid name or size of a shape is a usage error with the valid ones") {
  CHECK_THROWS_WITH_AS(makeShape("ball"),
                       "unknown shape 'ball'; choose plane, cube, sphere, torus, bumpy-sphere, sculpture", UsageError);
  for (const double size : {0.0, -1.0, std::nan(""), HUGE_VAL}) CHECK_THROWS_AS(makeShape("cube", size), UsageError);
  CHECK_THROWS_AS(makeShape("cube", 1, DVec3(HUGE_VAL)), UsageError);
}

TEST_CASE("an area table maps equal shares to equal masses") {
  // Density 1 + x + 2 y over the unit square, with a known mass below (x, y).
  const AreaTable table(
      8, 8, [](const DVec2& at) { return 1 + at.x + 2 * at.y; }, 1);
  for (const double share : {0.0, 0.1, 0.5, 0.77, 1.0}) {
    const DVec2 at = table({share, 0.3});
    const double marginal = (2 * at.x + 0.5 * at.x * at.x) / 2.5;
    const double conditional = ((1 + at.x) * at.y + at.y * at.y) / (2 + at.x);
    CHECK(marginal == within(share, 1e-12));
    CHECK(conditional == near(0.3, 1e-12));
  }
}

TEST_CASE("jets carry exact derivatives") {
  const auto f = [](const Jet& u, const Jet& v) { return exp(0.3 * u) * sin(u * v) + inverseSqrt(2.0 + cos(v)) - u; };
  const double u = 0.7, v = -1.1, h = 1e-4;
  const auto value = [&](double du, double dv) { return f(Jet(u + du), Jet(v + dv)).value; };
  const Jet jet = f(Jet::parameterU(u), Jet::parameterV(v));
  CHECK(jet.value == near(value(0, 0), 1e-12));
  CHECK(jet.u == near((value(h, 0) - value(-h, 0)) / (2 * h), 1e-6));
  CHECK(jet.v == near((value(0, h) - value(0, -h)) / (2 * h), 1e-6));
  CHECK(jet.uu == near((value(h, 0) - 2 * value(0, 0) + value(-h, 0)) / (h * h), 1e-5));
  CHECK(jet.vv == near((value(0, h) - 2 * value(0, 0) + value(0, -h)) / (h * h), 1e-5));
  CHECK(jet.uv == near((value(h, h) - value(h, -h) - value(-h, h) + value(-h, -h)) / (4 * h * h), 1e-5));
}

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

}  // namespace palpate::test::analytic_shape_test
