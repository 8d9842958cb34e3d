// The surface of Gaussians compared with the shape that they approximate: positions, normals, coverage, and no extra
// surface; degenerate scenes; positions on the discs, and the densities there, compared with sums over all discs.
#include "engine/cloud/gaussian_surface.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <memory>
#include <numbers>
#include <vector>

#include "engine/cloud/gaussian_seeds.hpp"
#include "engine/cloud/morton.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/cloud/spacing.hpp"
#include "tests/gaussian_scenes.hpp"
#include "tests/near.hpp"

namespace palpate::test::gaussian_surface_test {

namespace {

constexpr double kPi = std::numbers::pi;

struct KnownShape {
  std::unique_ptr<AnalyticShape> shape;
  double area;
};

KnownShape shapeNamed(std::string_view name, const DVec3& center = DVec3(0)) {
  constexpr double kSize = 100;
  const double area = name == "sphere"  ? kPi * kSize * kSize
                      : name == "torus" ? 4 * kPi * kPi * 0.35 * 0.15 * kSize * kSize
                      : name == "cube"  ? 6 * kSize * kSize
                                        : kSize * kSize;
  return {makeShape(name, kSize, center), area};
}

struct Share {
  double mean = 0, most = 0;  ///< 95th percentile
};

Share shareOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  double sum = 0;
  for (const double value : values) sum += value;
  return {sum / static_cast<double>(values.size()), values[values.size() * 95 / 100]};
}

struct Judged {
  Share distance;           ///< to the true surface, spacings of the Gaussians
  Share angle;              ///< to the true normal, degrees; for a plane, which has two faces, to its line
  std::size_t inwards = 0;  ///< points whose normal faces away from the true one
  double uncovered = 0;     ///< fraction of the true surface without a point within 1.5 spacings
  double farthest = 0;      ///< largest distance of a point from the surface, spacings of the Gaussians
};

Judged judge(const PointCloud& cloud, const KnownScene& known, const KnownShape& truth, bool twoFaces) {
  Judged judged;
  std::vector<double> distances, angles;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 place = cloud.fileCoordinates(i);
    const SurfacePoint closest = truth.shape->closest(place);
    distances.push_back(glm::distance(place, closest.position) / known.spacing);
    // On an edge of a cube the shape's normal points to the position, also from inside.
    const double angle = angleBetween_deg(DVec3(cloud.normals[i]), closest.normal);
    angles.push_back(twoFaces ? std::min(angle, 180 - angle) : angle);
    judged.inwards += angle > 90;
    judged.farthest = std::max(judged.farthest, distances.back());
  }
  judged.distance = shareOf(distances);
  judged.angle = shareOf(angles);
  const PointCloud places = sampleShape(*truth.shape, {.count = 5000, .seed = 77});
  const PointTree tree(cloud.positions);
  std::size_t uncovered = 0;
  for (std::size_t i = 0; i < places.size() && !cloud.empty(); ++i) {
    std::array<std::uint32_t, 1> nearest;
    std::array<double, 1> squared;
    tree.nearest(Vec3(places.fileCoordinates(i) - cloud.origin), nearest, squared);
    uncovered += std::sqrt(squared[0]) > 1.5 * known.spacing;
  }
  judged.uncovered = static_cast<double>(uncovered) / static_cast<double>(places.size());
  return judged;
}

SceneOptions trained() { return {.count = 20'000, .floaters = 0.05, .faint = 2, .huge = 5, .offset = 0.1}; }

bool sameBytes(const PointCloud& a, const PointCloud& b) {
  return a.origin == b.origin && a.positions == b.positions && a.normals == b.normals && a.colors == b.colors;
}

/// Distance of points from z = 0, at the rim of a square of `side` units and elsewhere.
struct Flatness {
  double inside = 0, rim = 0;
};
Flatness flatnessOf(const PointCloud& cloud, int side) {
  Flatness flatness;
  for (const Vec3& place : cloud.positions) {
    const bool inside = std::min(place.x, place.y) > 1 && std::max(place.x, place.y) < static_cast<float>(side - 2);
    double& worst = inside ? flatness.inside : flatness.rim;
    worst = std::max(worst, std::abs(static_cast<double>(place.z)));
  }
  return flatness;
}

bool isRight(const PointCloud& cloud) {
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!isFinite(cloud.positions[i]) || std::abs(glm::length(cloud.normals[i]) - 1) > 1e-4f) return false;
  return cloud.normals.size() == cloud.size() && cloud.colors.size() == cloud.size();
}

/// A square of Gaussians in z = 0, `side` of them along an edge, a unit apart.
GaussianScene square(int side) {
  GaussianScene scene;
  SceneRandom random(3);
  for (int i = 0; i < side * side; ++i) {
    const Vec4 rotation = rotationTo({0, 0, 1}, random);
    addGaussian(scene, DVec3(i % side, i / side, 0), {0.75, 0.75, 0.4}, rotation, 0.9, DVec3(0.5));
  }
  return scene;
}

/// Discs along the axes, from tiny ones to ten times the usual size.
std::vector<GaussianDisc> someDiscs(std::size_t count) {
  SceneRandom random(11);
  std::vector<GaussianDisc> discs;
  for (std::size_t i = 0; i < count; ++i) {
    const DVec3 center = random.inBox(DVec3(0), 40);
    const auto longest = static_cast<float>(0.2 * std::exp(4 * std::pow(random.unit(), 4)));
    GaussianDisc disc{.center = Vec3(center),
                      .opacity = 0.1f + 0.9f * static_cast<float>(random.unit()),
                      .longest = {longest, 0, 0},
                      .middle = {0, 0.7f * longest, 0},
                      .shortest = {0, 0, std::min(0.5f * longest, 1.0f)}};
    disc.reach = std::sqrt(2 * std::log(disc.opacity / 0.02f)) * (disc.longest + disc.middle + disc.shortest);
    discs.push_back(disc);
  }
  return discs;
}

double densityAt(const GaussianDisc& disc, const Vec3& place) {
  const DVec3 off = DVec3(place - disc.center) / DVec3(disc.longest + disc.middle + disc.shortest);
  return disc.opacity * std::exp(-0.5 * glm::dot(off, off));
}

}  // namespace

TEST_CASE("points cover the shape of the Gaussians, with its normals, and lie nowhere else") {
  for (const char* name : {"sphere", "torus", "cube", "plane"}) {
    CAPTURE(name);
    const KnownShape truth = shapeNamed(name);
    const KnownScene known = gaussiansOn(*truth.shape, truth.area, trained());
    const GaussianSurface surface = surfaceOf(known.scene);
    const bool plane = std::string_view(name) == "plane", cube = std::string_view(name) == "cube";
    const Judged judged = judge(surface.cloud, known, truth, plane);
    CHECK(isRight(surface.cloud));
    CHECK(judged.distance.mean < 0.07);
    CHECK(judged.distance.most < 0.15);
    CHECK(judged.angle.mean < 7);
    CHECK(judged.angle.most < 12);
    CHECK(judged.uncovered == 0);
    CHECK(judged.farthest < 1);  // the floaters are at least eight away
    // Next to a rounded edge of the cube, a face may be judged by its neighbour.
    if (!plane)
      CHECK(static_cast<double>(judged.inwards) <= (cube ? 0.01 : 0) * static_cast<double>(surface.cloud.size()));
    CHECK(surface.oversized == 5);
    CHECK(surface.faint == 2 * trained().count);
    const double spacing = meanSpacing(surface.cloud) / known.spacing;
    CHECK(spacing > 0.6);
    CHECK(spacing < 1.2);
  }
}

TEST_CASE("no two points of a face are closer than three quarters of the reported spacing") {
  const KnownShape truth = shapeNamed("torus");
  const GaussianSurface surface = surfaceOf(gaussiansOn(*truth.shape, truth.area, trained()).scene);
  const PointTree tree(surface.cloud.positions);
  for (const Vec3& place : surface.cloud.positions) {
    std::array<std::uint32_t, 2> nearest;
    std::array<double, 2> squared;
    tree.nearest(place, nearest, squared);
    REQUIRE(std::sqrt(squared[1]) > 0.74 * surface.spacing);
  }
}

TEST_CASE("a point has the colour of the Gaussians around it") {
  const KnownShape truth = shapeNamed("sphere");
  const PointCloud cloud = surfaceOf(gaussiansOn(*truth.shape, truth.area, trained()).scene).cloud;
  double worst = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 color = 255.0 * (0.5 + 0.5 * cloud.fileCoordinates(i) / truth.shape->size());
    worst = std::max({worst, std::abs(color.x - cloud.colors[i][0]), std::abs(color.y - cloud.colors[i][1]),
                      std::abs(63.75 - cloud.colors[i][2])});
    REQUIRE(cloud.colors[i][3] == 255);
  }
  CHECK(worst < 4);
}

TEST_CASE("the Gaussian surface does not depend on the number of threads") {
  const KnownShape truth = shapeNamed("torus");
  const GaussianScene scene = gaussiansOn(*truth.shape, truth.area, trained()).scene;
  const PointCloud once = surfaceOf(scene, 1).cloud;
  CHECK(once.size() > 10'000);
  for (const unsigned threads : {2u, 3u, 7u}) CHECK(sameBytes(surfaceOf(scene, threads).cloud, once));
}

TEST_CASE("far from the origin the Gaussian surface is the same, shifted") {
  const DVec3 far(1e6, -3e6, 5e5);
  const KnownShape truth = shapeNamed("sphere", far);
  const KnownScene known = gaussiansOn(*truth.shape, truth.area, {.count = 5000});
  const PointCloud cloud = surfaceOf(known.scene).cloud;
  const Judged judged = judge(cloud, known, truth, false);
  CHECK(judged.distance.mean < 0.1);
  CHECK(judged.uncovered == 0);
  CHECK(judged.inwards == 0);
}

TEST_CASE("the unit of a scene does not matter, from a billionth to a billion") {
  const GaussianScene scene = square(20);
  const std::size_t points = surfaceOf(scene).cloud.size();
  for (const double scale : {1e-9, 1e9}) {
    GaussianScene scaled = scene;
    for (DVec3& center : scaled.centers) center *= scale;
    for (Vec3& logs : scaled.logScales) logs += static_cast<float>(std::log(scale));
    const GaussianSurface surface = surfaceOf(scaled);
    CHECK(isRight(surface.cloud));
    // The usual radius is known to a sixty-fourth of its logarithm.
    CHECK(static_cast<double>(surface.cloud.size()) == near(static_cast<double>(points), 0.1));
  }
}

TEST_CASE("scenes without visible Gaussians have no surface") {
  CHECK(surfaceOf({}).cloud.empty());
  GaussianScene faint = square(10);
  for (float& logit : faint.opacityLogits) logit = -6;
  const GaussianSurface nothing = surfaceOf(faint);
  CHECK(nothing.cloud.empty());
  CHECK(nothing.faint == 100);
  for (const float log : {-100.0f, 100.0f, 3e38f, -3e38f}) {
    GaussianScene sizeless = square(10);
    for (Vec3& logs : sizeless.logScales) logs = Vec3(log);
    const GaussianSurface surface = surfaceOf(sizeless);
    CHECK(surface.cloud.empty());
    CHECK(surface.oversized == 100);
  }
}

TEST_CASE("one Gaussian, or many identical ones, give a small surface") {
  GaussianScene scene = square(1);
  const PointCloud one = surfaceOf(scene).cloud;
  CHECK_FALSE(one.empty());
  CHECK(isRight(one));
  for (const Vec3& place : one.positions) CHECK(glm::length(place) < 2);
  for (int i = 0; i < 1000; ++i) addGaussian(scene, DVec3(0), {0.75, 0.75, 0.4}, Vec4(1, 0, 0, 0), 0.9, DVec3(0.5));
  const PointCloud many = surfaceOf(scene).cloud;
  CHECK_FALSE(many.empty());
  CHECK(isRight(many));
}

TEST_CASE("Gaussians with absurd sizes, logits and rotations do not affect the others") {
  const GaussianScene scene = square(30);
  GaussianScene odd = scene;
  const auto add = [&](const DVec3& center, const Vec3& logs, const Vec4& rotation, float logit) {
    odd.centers.push_back(center);
    odd.logScales.push_back(logs);
    odd.rotations.push_back(rotation);
    odd.opacityLogits.push_back(logit);
    odd.colorHarmonics.emplace_back(0);
  };
  add({5, 5, 0}, Vec3(100), Vec4(1, 0, 0, 0), 10);
  add({5, 5, 0}, Vec3(-100), Vec4(1, 0, 0, 0), 10);
  add({5, 5, 0}, Vec3(0, -100, 100), Vec4(1, 0, 0, 0), 3e38f);
  add({1e29, 5, 0}, Vec3(0), Vec4(1, 0, 0, 0), 10);
  add({5, 5, 0}, Vec3(0), Vec4(3e38f, 3e38f, 0, 0), -3e38f);
  const GaussianSurface surface = surfaceOf(odd), plain = surfaceOf(scene);
  CHECK(surface.oversized == 3);
  CHECK(surface.outlying == 1);
  CHECK(surface.faint == 1);
  CHECK(isRight(surface.cloud));
  CHECK(flatnessOf(surface.cloud, 30).inside < 0.02);
  CHECK(static_cast<double>(surface.cloud.size()) == near(static_cast<double>(plain.cloud.size()), 0.05));
}

TEST_CASE("Gaussians far beside the surface are counted as outlying, and those near it are not") {
  const GaussianScene scene = square(30);
  GaussianScene floaters = scene;
  const auto add = [&](const DVec3& center) {
    SceneRandom random(1);
    addGaussian(floaters, center, {0.75, 0.75, 0.4}, rotationTo({0, 0, 1}, random), 0.9, {1, 0, 0});
  };
  for (const double far : {50.0, 3000.0, -1e5}) add({15, 15, far});
  add({-60, 15, 0});
  for (const double near : {3.0, -10.0}) add({15, 15, near});
  const GaussianSurface surface = surfaceOf(floaters);
  CHECK(surfaceOf(scene).outlying == 0);
  CHECK(surface.outlying == 4);
  CHECK(static_cast<double>(surface.cloud.size()) == near(static_cast<double>(surfaceOf(scene).cloud.size()), 0.05));
  CHECK(isRight(surface.cloud));
}

TEST_CASE("the length of a quaternion does not matter, and one of length zero means no rotation") {
  GaussianScene scene = square(20), zero = scene, longer = scene;
  for (Vec4& rotation : zero.rotations) rotation = Vec4(0);
  for (Vec4& rotation : longer.rotations) rotation *= 1e-25f;
  for (const GaussianScene& turned : {zero, longer}) {
    const PointCloud cloud = surfaceOf(turned).cloud;
    CHECK(cloud.size() > 300);
    CHECK(flatnessOf(cloud, 20).inside < 0.02);
    CHECK(flatnessOf(cloud, 20).rim < 0.3);
  }
}

TEST_CASE("flat and thick Gaussians of a plane give the same plane") {
  for (const float thickness : {-100.0f, -3.0f, -0.5f}) {
    GaussianScene scene = square(30);
    for (Vec3& logs : scene.logScales) logs.z = thickness;
    const PointCloud cloud = surfaceOf(scene).cloud;
    CHECK(cloud.size() > 600);
    CHECK(flatnessOf(cloud, 30).inside < 0.02);
    CHECK(flatnessOf(cloud, 30).rim < 0.3);
  }
}

TEST_CASE("a sheet whose Gaussians differ tenfold in size has no holes and no steps") {
  GaussianScene scene = square(40);
  SceneRandom random(5);
  // A coarse square, like a wall, beside the fine one.
  for (int i = 0; i < 100; ++i) {
    const Vec4 rotation = rotationTo({0, 0, 1}, random);
    addGaussian(scene, DVec3(42 + 6 * (i % 10), 6 * (i / 10), 0), {4.5, 4.5, 2.4}, rotation, 0.9, DVec3(0.5));
  }
  const PointCloud cloud = surfaceOf(scene).cloud;
  const PointTree tree(cloud.positions);
  for (double x = 1; x < 90; x += 1.5)
    for (double y = 2; y < 37; y += 1.5) {
      std::array<std::uint32_t, 1> nearest;
      std::array<double, 1> squared;
      tree.nearest(Vec3(x, y, 0), nearest, squared);
      CHECK(std::sqrt(squared[0]) < 2.5);
    }
}

TEST_CASE("seeds are in the order of their voxels, one per voxel, on the discs that they name") {
  const std::vector<GaussianDisc> discs = someDiscs(3000);
  const BareVector<GaussianSeed> seeds = seedsOver(discs, 1);
  CHECK(seeds.size() > 3000);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const GaussianSeed& seed = seeds[i];
    REQUIRE(seed.voxel == mortonCode(mortonCell(seed.place, kSeedVoxel)));
    if (i > 0) REQUIRE(seeds[i - 1].voxel < seed.voxel);
    const GaussianDisc& disc = discs[seed.disc];
    REQUIRE(densityAt(disc, seed.place) > 0.54 * static_cast<double>(disc.opacity));  // within 1.1 deviations
    REQUIRE(std::abs(seed.place.z - disc.center.z) < 1e-5f);
  }
  for (const unsigned threads : {2u, 5u}) {
    const BareVector<GaussianSeed> same = seedsOver(discs, threads);
    CHECK(std::ranges::equal(same, seeds, [](const GaussianSeed& a, const GaussianSeed& b) {
      return a.voxel == b.voxel && a.place == b.place && a.disc == b.disc;
    }));
  }
}

TEST_CASE("of coincident discs the first one gets the seeds, and no discs give none") {
  std::vector<GaussianDisc> discs(50, someDiscs(1)[0]);
  for (GaussianDisc& disc : discs) disc.longest.x = disc.middle.y = 5;
  const BareVector<GaussianSeed> seeds = seedsOver(discs, 3);
  const auto first = std::ranges::count(seeds, 0u, &GaussianSeed::disc);
  CHECK(static_cast<std::size_t>(first) > seeds.size() / 2);
  CHECK(static_cast<std::size_t>(first) == seedsOver(std::span(discs).first(1), 3).size());
  CHECK(seedsOver({}, 3).empty());
}

TEST_CASE("each seed gathers exactly the Gaussians within reach, without duplicates") {
  const std::vector<GaussianDisc> discs = someDiscs(3000);
  const BareVector<GaussianSeed> seeds = seedsOver(discs, 1);
  for (const float margin : {0.0f, 2.0f, 5.0f}) {
    CAPTURE(margin);
    const SeedCells cells(discs, seeds, margin, 2);
    GaussiansAround around(cells);
    std::size_t next = 0;
    for (std::size_t cell = 0; cell < cells.count(); ++cell) {
      const auto [first, last] = cells.seedsOf(cell);
      REQUIRE(first == next);
      next = last;
      GaussianRegion region;
      for (std::size_t i = first; i < last; ++i) region.widen(seeds[i].place - margin), region.widen(seeds[i].place);
      GaussianDensity density;
      around.gather(cell, region, density);
      if (cell % 10 != 0) continue;
      // At the seed, and as far from it as the margin allows.
      for (const Vec3& place : {seeds[first].place, seeds[first].place - margin}) {
        double felt = 0, all = 0;
        for (const GaussianDisc& disc : discs) {
          const double one = densityAt(disc, place);
          all += one;
          if (glm::all(glm::lessThan(glm::abs(place - disc.center), 0.999f * disc.reach))) felt += one;
        }
        const auto got = static_cast<double>(density.slopeAt(place).density);
        CHECK(density.densityAt(place) == near(density.slopeAt(place).density, 1e-6));
        CHECK(got > felt - 1e-3 * (1 + felt));
        CHECK(got < all + 1e-3 * (1 + all));
      }
    }
    CHECK(next == seeds.size());
  }
}

}  // namespace palpate::test::gaussian_surface_test
