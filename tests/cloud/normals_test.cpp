// Estimated normals, and normals of points seen by cameras, compared with the shapes that the points were sampled from.
#include "engine/cloud/normals.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/view_normals.hpp"
#include "tests/near.hpp"

namespace palpate::test::normals_test {

namespace {

/// Cosine of the worst angle between the estimated normals and the true ones; negative if any is reversed.
float worstCosine(PointCloud cloud, unsigned threads = 0) {
  const std::vector<Vec3> truth = cloud.normals;
  estimateNormals(cloud, 16, threads);
  float worst = 1;
  for (std::size_t i = 0; i < cloud.size(); ++i) worst = std::min(worst, glm::dot(truth[i], cloud.normals[i]));
  return worst;
}

struct SeenShape {
  PointCloud cloud;
  std::vector<PointSight> sights;
  std::vector<DVec3> truth;
};

DVec3 direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return glm::normalize(DVec3(x, y, z));
}

/// A sphere of radius 10, each point seen from `views` positions outside; `bad`: fraction of points that are half a
/// unit off and marked so.
SeenShape seenSphere(std::size_t count, int views, double bad) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> noise;
  SeenShape seen;
  for (std::size_t i = 0; i < count; ++i) {
    const DVec3 out = direction(random);
    const bool isBad = share(random) < bad;
    const DVec3 place = (10 + (isBad ? 0.5 : 0.01) * noise(random)) * out;
    DVec3 towards(0);
    for (int v = 0; v < views; ++v) {
      // From a random position on a sphere three times as large from which the point is visible.
      DVec3 eye(0);
      while (glm::dot(eye - place, out) <= 0) eye = 30.0 * direction(random);
      towards += glm::normalize(eye - place);
    }
    seen.cloud.positions.emplace_back(place);
    seen.sights.push_back({.towardsViews = towards, .weight = isBad ? 1e-3 : 1.0});
    seen.truth.push_back(out);
  }
  return seen;
}

/// RMS angle to the truth, degrees; number of normals that face inwards.
struct Judged {
  double angle = 0;
  std::size_t inwards = 0;
};
Judged judge(const SeenShape& seen) {
  constexpr double kDegrees = 57.29577951308232;
  Judged judged;
  for (std::size_t i = 0; i < seen.truth.size(); ++i) {
    const double cosine = glm::dot(DVec3(seen.cloud.normals[i]), seen.truth[i]);
    judged.inwards += cosine < 0;
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees;
    judged.angle += angle * angle / static_cast<double>(seen.truth.size());
    CHECK(glm::length(DVec3(seen.cloud.normals[i])) == near(1, 1e-6));
  }
  judged.angle = std::sqrt(judged.angle);
  return judged;
}

}  // namespace

TEST_CASE("estimated normals are accurate within degrees and face outwards") {
  CHECK(worstCosine(sampleShape(*makeShape("torus"), {.count = 50'000})) > std::cos(0.03));
  CHECK(worstCosine(sampleShape(*makeShape("bumpy-sphere"), {.count = 50'000})) > std::cos(0.05));
  CHECK(worstCosine(sampleShape(*makeShape("torus"), {.count = 50'000, .noise = 0.1})) > std::cos(0.35));
  CHECK(worstCosine(sampleShape(*makeShape("plane", 1e-4), {.count = 1000})) > 0.9999f);
}

TEST_CASE("each connected part of a cloud has normals that face outwards") {
  PointCloud cloud = sampleShape(*makeShape("sphere", 10), {.count = 5000});
  const PointCloud other = sampleShape(*makeShape("torus", 10, DVec3(30, 0, -7)), {.count = 5000});
  cloud.positions.insert(cloud.positions.end(), other.positions.begin(), other.positions.end());
  cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
  CHECK(worstCosine(cloud) > std::cos(0.1));
}

TEST_CASE("edges between planes are kept, and smooth surfaces are unchanged") {
  for (const char* shape : {"cube", "bumpy-sphere"}) {
    const PointCloud cloud = sampleShape(*makeShape(shape), {.count = 20'000});
    std::vector<FittedPlane> planes(cloud.size());
    NeighbourGraph graph{.degree = 16, .neighbours = BareVector<std::uint32_t>(16 * cloud.size())};
    std::vector<std::uint32_t> all(cloud.size());
    std::iota(all.begin(), all.end(), 0u);
    fitNearestPlanes(cloud.positions, all, 16, planes, graph);
    const std::vector<Vec3> kept = keepEdges(cloud.positions, planes);
    double before = 0, after = 0;
    std::size_t changed = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (kept[i] == planes[i].normal) continue;
      ++changed;
      before += 1 - std::abs(glm::dot(planes[i].normal, cloud.normals[i]));
      after += 1 - std::abs(glm::dot(kept[i], cloud.normals[i]));
    }
    if (std::string(shape) == "bumpy-sphere") {
      CHECK(changed == 0);
    } else {
      CHECK(changed > 1000);
      CHECK(after < 0.4 * before);
    }
  }
}

TEST_CASE("normals do not depend on duplicates or the number of threads") {
  PointCloud cloud = sampleShape(*makeShape("torus"), {.count = 5000});
  PointCloud doubled = cloud;
  for (int copy = 0; copy < 20; ++copy)
    doubled.positions.insert(doubled.positions.end(), cloud.positions.begin(), cloud.positions.end());
  estimateNormals(cloud, 16, 1);
  estimateNormals(doubled, 16, 3);
  for (std::size_t i = 0; i < doubled.size(); ++i) REQUIRE(doubled.normals[i] == cloud.normals[i % cloud.size()]);
}

TEST_CASE("degenerate clouds get unit normals") {
  PointCloud cloud;
  estimateNormals(cloud);
  CHECK_FALSE(cloud.hasNormals());
  std::vector<std::vector<Vec3>> clouds{
      {Vec3(1)}, {Vec3(0), Vec3(1, 2, 3)}, {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, std::vector<Vec3>(20'000, Vec3(4))};
  clouds.emplace_back();
  for (int i = 0; i < 100; ++i) clouds.back().emplace_back(static_cast<float>(i), 0.0f, 0.0f);
  for (const auto& positions : clouds) {
    cloud.positions = positions;
    estimateNormals(cloud);
    REQUIRE(cloud.normals.size() == positions.size());
    for (const Vec3& normal : cloud.normals) CHECK(std::abs(glm::length(normal) - 1) < 1e-5f);
  }
  CHECK(std::abs(cloud.normals[50].x) < 1e-5f);  // perpendicular to the line
}

TEST_CASE("normals of camera views are those of the shape, and face the cameras") {
  SeenShape seen = seenSphere(4000, 3, 0);
  normalsFromViews(seen.cloud, seen.sights);
  const Judged judged = judge(seen);
  CHECK(judged.angle < 4);
  CHECK(judged.inwards == 0);
  const std::vector<Vec3> one = seen.cloud.normals;
  normalsFromViews(seen.cloud, seen.sights, 16, 1);
  CHECK(seen.cloud.normals == one);
}

TEST_CASE("points with low confidence hardly affect normals") {
  SeenShape seen = seenSphere(4000, 3, 0.2);
  normalsFromViews(seen.cloud, seen.sights);
  const double weighed = judge(seen).angle;
  for (PointSight& sight : seen.sights) sight.weight = 1;
  normalsFromViews(seen.cloud, seen.sights);
  CHECK(weighed < 0.6 * judge(seen).angle);
}

TEST_CASE("a point without views, or seen edge-on, gets the side of its neighbours") {
  SeenShape seen = seenSphere(4000, 3, 0);
  for (std::size_t i = 0; i < seen.sights.size(); i += 5) {
    const DVec3 out = seen.truth[i];
    const DVec3 aside = glm::normalize(glm::cross(out, std::abs(out.z) < 0.9 ? DVec3(0, 0, 1) : DVec3(1, 0, 0)));
    seen.sights[i].towardsViews = i % 10 == 0 ? DVec3(0) : aside - 0.05 * out;
  }
  normalsFromViews(seen.cloud, seen.sights);
  CHECK(judge(seen).inwards == 0);
}

TEST_CASE("normals that face away from their views are flipped; those without views, and all others, stay") {
  SeenShape seen = seenSphere(500, 3, 0);
  std::vector<Vec3> expected;
  std::size_t inwards = 0;
  for (std::size_t i = 0; i < seen.truth.size(); ++i) {
    const bool isTurned = i % 3 == 0, isUnseen = i % 7 == 0;
    const Vec3 out(seen.truth[i]);
    seen.cloud.normals.push_back(isTurned ? -out : out);
    expected.push_back(isTurned && isUnseen ? -out : out);
    if (isUnseen) seen.sights[i].towardsViews = DVec3(0);
    inwards += isTurned && !isUnseen;
  }
  CHECK(faceViews(seen.cloud, seen.sights) == inwards);
  CHECK(seen.cloud.normals == expected);
  CHECK(faceViews(seen.cloud, seen.sights) == 0);
}

TEST_CASE("a view adds the unit direction to it, and a view from the point itself adds zero") {
  PointSight sight;
  sight.addView({1, 2, 3}, {1, 2, 13});
  sight.addView({1, 2, 3}, {-4, 2, 3});
  sight.addView({1, 2, 3}, {1, 2, 3});
  CHECK(sight.towardsViews == DVec3(-1, 0, 1));
}

TEST_CASE("empty, single, coincident and collinear points have unit normals that face their views") {
  for (const std::size_t count : {0, 1, 2, 40})
    for (const float step : {0.0f, 0.1f}) {
      CAPTURE(count);
      PointCloud cloud;
      std::vector<PointSight> sights;
      for (std::size_t i = 0; i < count; ++i) {
        cloud.positions.emplace_back(1e3f + step * static_cast<float>(i), 5, -2);
        sights.push_back({.towardsViews = {0, 2, 0}, .weight = 1});
      }
      normalsFromViews(cloud, sights);
      REQUIRE(cloud.normals.size() == count);
      for (const Vec3& normal : cloud.normals) CHECK(normal == Vec3(0, 1, 0));
    }
}

}  // namespace palpate::test::normals_test
