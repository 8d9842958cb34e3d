#include "engine/cloud/spacing.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/thinning.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"

namespace palpate::test::spacing_test {

namespace {

PointCloud randomSquare(std::size_t count) {
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i)
    cloud.positions.emplace_back(static_cast<float>(randomUnit(1, i)), static_cast<float>(randomUnit(2, i)), 0.0f);
  return cloud;
}

double measured(const PointCloud& cloud) { return spacingRange(cloud).noise; }

/// Positions with a deviation of `noise` spacings in each direction.
PointCloud noisyCloud(const AnalyticShape& shape, double noise, std::size_t count) {
  constexpr std::size_t kFew = 20'000;
  const double spacing = meanSpacing(sampleShape(shape, {.count = std::min(kFew, count)})) *
                         std::sqrt(static_cast<double>(std::min(kFew, count)) / static_cast<double>(count));
  return sampleShape(shape, {.count = count, .noise = noise * spacing});
}
PointCloud noisyCloud(std::string_view name, double noise, std::size_t count = 100'000,
                      const DVec3& center = DVec3(0)) {
  return noisyCloud(*makeShape(name, 100, center), noise, count);
}

std::vector<DVec3> quadricPoints(std::size_t count, double noise) {
  std::vector<DVec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 2 * randomUnit(1, i) - 1, y = 2 * randomUnit(2, i) - 1;
    points.emplace_back(x, 0.1 * x * x - 0.2 * x * y + 0.05 * y * y + noise * randomNormal3(3, i).x, y);
  }
  return points;
}

std::size_t countBetween(const PointCloud& cloud, float low, float high) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cloud.positions, [&](const Vec3& p) { return p.x >= low && p.x < high; }));
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

TEST_CASE("the wide spacing is that of a half with a hundredth of the density, and not of points that float about") {
  PointCloud halves = randomSquare(100'000);
  for (const Vec3& place : randomSquare(1'000).positions) halves.positions.push_back(place + Vec3(1, 0, 0));
  CHECK(spacingRange(halves).wide == near(0.0316, 0.25));
  PointCloud floating = sampleShape(*makeShape("sphere"), {.count = 50'000});
  const double wide = spacingRange(floating).wide;
  for (std::uint64_t i = 0; i < 500; ++i)
    floating.positions.emplace_back(
        Vec3(randomUnit(2, 3 * i), randomUnit(2, 3 * i + 1), randomUnit(2, 3 * i + 2)) * 400.f - 200.f);
  CHECK(spacingRange(floating).wide < 1.2 * wide);
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

TEST_CASE("the noise of every shape is measured, and exact points have next to none") {
  for (const std::string name : {"plane", "cube", "sphere", "torus", "bumpy-sphere"}) {
    CAPTURE(name);
    constexpr std::size_t kPoints = 30'000;
    const auto shape = makeShape(name);
    CHECK(measured(noisyCloud(*shape, 0, kPoints)) < 0.001);
    CHECK(measured(noisyCloud(*shape, 0.1, kPoints)) == near(0.1, 0.12));
    CHECK(measured(noisyCloud(*shape, 0.25, kPoints)) == near(0.25, 0.08));
    CHECK(measured(noisyCloud(*shape, 0.5, kPoints)) == near(0.47, 0.06));
  }
}

TEST_CASE("noise is measured also if folds are hardly wider than the examined neighbourhoods" * kMoreInFull) {
  constexpr std::size_t kPoints = 100'000;
  const auto shape = makeShape("sculpture");
  CHECK(measured(noisyCloud(*shape, 0, kPoints)) < 0.03);
  CHECK(measured(noisyCloud(*shape, 0.25, kPoints)) == near(0.25, 0.08));
  if (!inFullTier()) return;
  CHECK(measured(noisyCloud(*shape, 0.1, kPoints)) == near(0.1, 0.12));
  CHECK(measured(noisyCloud(*shape, 0.5, kPoints)) == near(0.47, 0.06));
}

TEST_CASE("noise is measured in local spacings where density changes") {
  const PointCloud clean = thinnedAlong(noisyCloud("sphere", 0), 10);
  CHECK(measured(clean) < 0.001);
  // The dense half has a noise of a quarter of its spacing, the sparse half, three times as far apart, a quarter of its
  // own.
  PointCloud cloud = noisyCloud("plane", 0.25, 40'000);
  for (const Vec3& p : noisyCloud("plane", 0.25, 40'000).positions)
    cloud.positions.push_back(3.0f * p + Vec3(0, 0, 100));
  CHECK(measured(cloud) == near(0.25, 0.08));
}

TEST_CASE("edges, coincident points and outliers do not count as noise") {
  // A twentieth of the points is a spacing off: half of the neighbourhoods contain one of them.
  PointCloud cloud = noisyCloud("cube", 0);
  const double spacing = meanSpacing(cloud);
  for (std::size_t i = 0; i < cloud.size(); i += 60)
    cloud.positions[i] += static_cast<float>(spacing) * cloud.normals[i];
  CHECK(measured(cloud) < 0.01);
  PointCloud twice = noisyCloud("torus", 0.25);
  const std::vector<Vec3> once = twice.positions;
  twice.positions.insert(twice.positions.end(), once.begin(), once.end());
  CHECK(measured(twice) == near(0.25, 0.08));
}

TEST_CASE("noise far from the origin is that of the points, not of rounding") {
  CHECK(measured(noisyCloud("sphere", 0, 100'000, DVec3(1e6))) < 0.001);
  CHECK(measured(noisyCloud("sphere", 0.25, 100'000, DVec3(1e6))) == near(0.25, 0.08));
}

TEST_CASE("the noise of a cloud of millions is measured on a sample, in the cloud's spacings") {
  CHECK(measured(noisyCloud("torus", 0.25, 2'500'000)) == near(0.25, 0.1));
}

TEST_CASE("a cloud without a surface has no noise") {
  PointCloud cloud;
  CHECK(measured(cloud) == 0);
  cloud.positions = {Vec3(1)};
  CHECK(measured(cloud) == 0);
  cloud.positions.assign(10'000, Vec3(1, 2, 3));
  CHECK(measured(cloud) == 0);
  cloud.positions.clear();
  for (int i = 0; i < 5'000; ++i) cloud.positions.emplace_back(0.1f * static_cast<float>(i), 0.0f, 0.0f);
  CHECK(measured(cloud) == 0);
  cloud.positions.resize(kNoisePoints - 1);
  CHECK(measured(cloud) == 0);
}

TEST_CASE("the measured noise does not depend on the number of threads") {
  const PointCloud cloud = noisyCloud("bumpy-sphere", 0.1, 20'000);
  CHECK(spacingRange(cloud, 1).noise == spacingRange(cloud, 5).noise);
}

TEST_CASE("points off a quadric have their given variance, in any unit") {
  const auto exact = varianceOffQuadric(quadricPoints(40, 0));
  REQUIRE(exact);
  CHECK(*exact < 1e-4);  // third-order terms remain, because it is tilted against the fitted plane
  const std::vector<DVec3> noisy = quadricPoints(4000, 0.3);
  REQUIRE(varianceOffQuadric(noisy));
  CHECK(*varianceOffQuadric(noisy) == near(0.09, 0.06));
  std::vector<DVec3> small;
  for (const DVec3& p : noisy) small.push_back(1e-9 * p + DVec3(1e-3));
  CHECK(*varianceOffQuadric(small) == near(1e-18 * *varianceOffQuadric(noisy), 1e-3));
  // Six coefficients fit any six points.
  CHECK_FALSE(varianceOffQuadric(std::span(noisy).first(6)));
  CHECK_FALSE(varianceOffQuadric({}));
  CHECK_FALSE(varianceOffQuadric(std::vector<DVec3>(16, DVec3(1, 2, 3))));
}

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

}  // namespace palpate::test::spacing_test
