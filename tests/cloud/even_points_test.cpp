#include "engine/cloud/even_points.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "tests/gaussian_scenes.hpp"
#include "tests/near.hpp"

namespace palpate::test::even_points_test {
namespace {

struct Points {
  std::vector<Vec3> places, normals;
};

Points inSquare(std::size_t count, float side) {
  Points points;
  SceneRandom random(9);
  for (std::size_t i = 0; i < count; ++i) {
    const DVec3 place = random.inBox(DVec3(0), 1);
    points.places.emplace_back(side * static_cast<float>(place.x), side * static_cast<float>(place.y), 0);
    points.normals.emplace_back(0, 0, 1);
  }
  return points;
}

}  // namespace

TEST_CASE("even points are never too close, and none could be added, with any number of threads") {
  for (const std::size_t count : {0u, 1u, 2u, 1000u, 20'000u}) {
    const Points points = inSquare(count, 20);
    const BareVector<std::uint32_t> chosen = evenlySpaced(points.places, points.normals, 1, 1);
    CHECK(std::ranges::is_sorted(chosen));
    for (const unsigned threads : {2u, 5u}) CHECK(evenlySpaced(points.places, points.normals, 1, threads) == chosen);
    for (std::size_t a = 0; a < chosen.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        REQUIRE(glm::distance(points.places[chosen[a]], points.places[chosen[b]]) >= 1);
    for (const Vec3& place : points.places) {
      const bool near = std::ranges::any_of(
          chosen, [&](std::uint32_t other) { return glm::distance(points.places[other], place) < 1; });
      REQUIRE(near);
    }
  }
}

TEST_CASE("the two faces of a sheet do not exclude each other's points, and coincident points of one face do") {
  Points points = inSquare(1, 1);
  for (int copy = 0; copy < 5; ++copy) {
    points.places.push_back(points.places[0]);
    points.normals.push_back(points.normals[0]);
  }
  CHECK(evenlySpaced(points.places, points.normals, 1) == BareVector<std::uint32_t>{0});
  points.normals[3] = {0, 0, -1};
  CHECK(evenlySpaced(points.places, points.normals, 1) == BareVector<std::uint32_t>{0, 3});
}

TEST_CASE("isolated points, and points whose neighbours face elsewhere, are left out") {
  Points points = inSquare(500, 5);
  const auto others = [&](std::size_t i) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < points.places.size(); ++k)
      count += k != i && glm::distance(points.places[k], points.places[i]) < 0.4f &&
               glm::dot(points.normals[k], points.normals[i]) > 0.5f;
    return count;
  };
  points.places.emplace_back(100, 0, 0), points.normals.emplace_back(0, 0, 1);
  points.places.emplace_back(0, 0, 0), points.normals.emplace_back(1, 0, 0);
  BareVector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < points.places.size(); ++i)
    if (others(i) >= 8) expected.push_back(i);
  CHECK(expected.size() > 100);
  CHECK(expected.size() < 500);
  for (const unsigned threads : {1u, 4u}) CHECK(inCompany(points.places, points.normals, 0.4f, 8, threads) == expected);
}

TEST_CASE("noise in normals is averaged, and an edge between two faces is kept") {
  Points points = inSquare(4000, 10);
  SceneRandom random(4);
  for (std::size_t i = 0; i < points.places.size(); ++i) {
    const bool wall = points.places[i].x < 0;
    const DVec3 normal = (wall ? DVec3(-1, 0, 0) : DVec3(0, 0, 1)) + 0.1 * random.direction();
    points.normals[i] = Vec3(glm::normalize(normal));
  }
  const BareVector<Vec3> once = smoothedNormals(points.places, points.normals, 0.5f, 1);
  CHECK(smoothedNormals(points.places, points.normals, 0.5f, 3) == once);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < once.size(); ++i) {
    const DVec3 truth = points.places[i].x < 0 ? DVec3(-1, 0, 0) : DVec3(0, 0, 1);
    before += angleBetween_deg(DVec3(points.normals[i]), truth);
    after += angleBetween_deg(DVec3(once[i]), truth);
    REQUIRE(glm::length(once[i]) == near(1, 1e-6));
  }
  CHECK(after < before / 3);
}

}  // namespace palpate::test::even_points_test
