// Normals of points seen by cameras, compared with the shapes that the points were sampled from.
#include "engine/cloud/view_normals.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/near.hpp"

namespace palpate::test::view_normals_test {
namespace {

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

}  // namespace palpate::test::view_normals_test
