// Nearest positions and ray casts, compared with shapes whose closest points and intersections are known.
#include <doctest/doctest.h>

#include <limits>
#include <string_view>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/ray_cast.hpp"
#include "engine/contact/contact_reference.hpp"
#include "engine/contact/proxy_tracker.hpp"
#include "engine/contact/surface_index.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::surface_index_test {

namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

SurfaceIndex indexOf(const PointCloud& cloud, const SurfaceOptions& options) {
  return {cloud.positions, cloud.normals, std::vector<std::uint8_t>(cloud.size(), 1), options, 2};
}

struct Indexed {
  Scene scene;
  SurfaceIndex index;
  Indexed(std::string_view shape, std::size_t points, SurfaceKind kind)
      : scene(makeScene(shape, points)), index(indexOf(scene.cloud, {.radius = scene.radius, .kind = kind})) {}
};

DVec3 randomDirection(std::uint64_t i) {
  const double z = 2 * randomUnit(7, 2 * i) - 1, turn = 6.283185307179586 * randomUnit(7, 2 * i + 1);
  return {std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z};
}

double nearestPointDistance(const PointCloud& cloud, const DVec3& x) {
  double least = kEndless;
  for (const Vec3& point : cloud.positions) least = std::min(least, glm::distance(x, DVec3(point)));
  return least;
}

}  // namespace

TEST_CASE("the nearest position on a sphere and a torus is the true one, from near, from far and from inside") {
  for (const std::string_view name : {"sphere", "torus"}) {
    CAPTURE(name);
    const Indexed indexed(name, 20'000, SurfaceKind::sphere);
    const auto& [scene, index] = indexed;
    for (std::uint64_t i = 0; i < 200; ++i) {
      const DVec3 x = scene.shape->center() + (i % 4 == 0 ? 400.0 : i % 2 == 0 ? 80.0 : 45.0) * randomDirection(i);
      CAPTURE(i);
      const SurfacePoint truth = scene.shape->closest(x);
      const auto hit = index.nearest(x, kEndless);
      REQUIRE(hit);
      const double distance = glm::distance(x, truth.position);
      CHECK(hit->distance == within(distance, 0.002 * scene.radius));
      CHECK(std::abs(scene.shape->signedDistance(hit->position)) < 0.002 * scene.radius);
      CHECK(hit->behind == (scene.shape->signedDistance(x) < 0));
      if (distance > 2) CHECK(angleBetween_deg(hit->normal, hit->behind ? hit->position - x : x - hit->position) < 1);
      CHECK(glm::distance(hit->position, DVec3(scene.cloud.positions[hit->point])) ==
            within(nearestPointDistance(scene.cloud, hit->position), 1e-4));
      CHECK_FALSE(index.nearest(x, 0.99 * distance));
      CHECK(index.nearest(x, 1.01 * distance + 0.01 * scene.radius));
    }
  }
}

TEST_CASE("a ray hits a sphere and a torus where the true surface is, or misses as it does") {
  for (const std::string_view name : {"sphere", "torus"}) {
    CAPTURE(name);
    const Indexed indexed(name, 20'000, SurfaceKind::sphere);
    const auto& [scene, index] = indexed;
    const TracedSurface traced = palpate::traced(*scene.shape);
    int hits = 0, misses = 0;
    for (std::uint64_t i = 0; i < 400; ++i) {
      CAPTURE(i);
      const DVec3 from = 300.0 * randomDirection(i);
      const DVec3 along = glm::normalize(70.0 * randomDirection(i + 1000) - from);
      const auto truth = castRay(traced, {from, along});
      const auto hit = index.castRay(from, along, kEndless);
      // Rays that graze the surface may do either.
      if (!truth || std::abs(glm::dot(truth->normal, along)) < 0.1) {
        misses += !truth && !hit;
        if (hit) CHECK(std::abs(scene.shape->signedDistance(hit->position)) < 0.02 * scene.radius);
        continue;
      }
      REQUIRE(hit);
      ++hits;
      CHECK(hit->distance == within(truth->depth, 0.02 * scene.radius));
      CHECK(angleBetween_deg(hit->normal, truth->normal) < 1);
      CHECK_FALSE(hit->behind);
      CHECK_FALSE(index.castRay(from, along, truth->depth - 0.1 * scene.radius));
    }
    CHECK(hits > 70);
    CHECK(misses > 20);
  }
}

TEST_CASE("a ray that starts inside a ball hits it from behind, and one that starts beyond it does not") {
  const Indexed ball("sphere", 20'000, SurfaceKind::sphere);
  for (std::uint64_t i = 0; i < 50; ++i) {
    const DVec3 along = randomDirection(i);
    const auto hit = ball.index.castRay(DVec3(0), along, kEndless);
    REQUIRE(hit);
    CHECK(hit->behind);
    CHECK(hit->distance == within(50, 0.01));
    CHECK(glm::dot(hit->normal, along) == within(1, 1e-4));
    CHECK_FALSE(ball.index.castRay(52.0 * along, along, kEndless));
    CHECK_FALSE(ball.index.castRay(52.0 * along, randomDirection(i), 0));
  }
}

TEST_CASE("a box of sharp edges is hit on its faces, and both faces of a thin plate are found") {
  const Indexed box("cube", 60'000, SurfaceKind::sharp);
  for (std::uint64_t i = 0; i < 60; ++i) {
    const DVec3 aim(80 * randomUnit(3, 2 * i) - 40, 80 * randomUnit(3, 2 * i + 1) - 40, 50);
    const auto hit = box.index.castRay(aim + DVec3(20, -10, 200), DVec3(-20, 10, -200) / std::sqrt(40500.0), kEndless);
    REQUIRE(hit);
    CHECK(glm::distance(hit->position, aim) < 0.05);
    CHECK(hit->normal.z == within(1, 1e-3));
    const auto foot = box.index.nearest(aim + DVec3(0, 0, 7), kEndless);
    REQUIRE(foot);
    CHECK(foot->distance == within(7, 0.01));
  }
  PointCloud plate;  // two sheets, a spacing apart and back to back
  for (int i = 0; i < 100 * 100; ++i)
    for (const float side : {1.0f, -1.0f}) {
      plate.positions.emplace_back(i % 100, i / 100, 0.5f * side);
      plate.normals.emplace_back(0, 0, side);
    }
  const SurfaceIndex index = indexOf(plate, {.radius = 4});
  for (const double side : {1.0, -1.0}) {
    const auto hit = index.castRay({50.3, 49.6, 30 * side}, {0, 0, -side}, kEndless);
    REQUIRE(hit);
    CHECK(hit->position.z == within(0.5 * side, 1e-6));
    CHECK(hit->normal.z == within(side, 1e-6));
    const auto foot = index.nearest({50.3, 49.6, 3 * side}, kEndless);
    REQUIRE(foot);
    CHECK(foot->position.z == within(0.5 * side, 1e-6));
  }
}

TEST_CASE("a ray along a plane misses it, one through its hole passes, and its rim is its end") {
  PointCloud sheet;
  for (int i = 0; i < 100 * 100; ++i) {
    const Vec3 point(i % 100, i / 100, 0);
    if (glm::distance(point, Vec3(50, 50, 0)) < 12) continue;
    sheet.positions.push_back(point);
    sheet.normals.emplace_back(0, 0, 1);
  }
  const SurfaceIndex index = indexOf(sheet, {.radius = 4});
  CHECK(index.castRay({20, 20, 9}, {0, 0, -1}, kEndless));
  CHECK_FALSE(index.castRay({50, 50, 9}, {0, 0, -1}, kEndless));
  CHECK_FALSE(index.castRay({-50, 30, 1}, {1, 0, 0}, kEndless));
  CHECK_FALSE(index.castRay({200, 30, 9}, {0, 0, -1}, kEndless));
  const auto rim = index.nearest({110, 30, 0.5}, kEndless);
  REQUIRE(rim);
  CHECK(rim->position.x > 98.9);
  CHECK(rim->position.x < 101.1);  // a surface ends within half a support radius of its last points
  const auto back = index.castRay({20, 20, -9}, {0, 0, 1}, kEndless);
  REQUIRE(back);
  CHECK(back->behind);
  CHECK(back->normal.z == within(1, 1e-9));
}

TEST_CASE("without a surface nothing is found: no points, one point, points far apart") {
  PointCloud cloud;
  for (const int points : {0, 1, 5}) {
    while (cloud.size() < static_cast<std::size_t>(points)) {
      cloud.positions.emplace_back(10 * cloud.size(), 0, 0);
      cloud.normals.emplace_back(0, 0, 1);
    }
    const SurfaceIndex index = indexOf(cloud, {.radius = 4});
    CHECK_FALSE(index.nearest({1, 1, 1}, kEndless));
    CHECK_FALSE(index.castRay({0, 0, 9}, {0, 0, -1}, kEndless));
  }
}

TEST_CASE("the nearest position is where a hand's proxy comes to rest") {
  const Indexed ball("sphere", 20'000, SurfaceKind::average);
  ProxyTracker tracker(ball.scene.radius);
  const ContactReference reference(ball.scene.cloud, {.radius = ball.scene.radius});
  for (int i = 0; i < 200; ++i) tracker.follow(reference, {3, -2, 52 - 0.02 * i});
  for (int i = 0; i < 50; ++i) tracker.follow(reference, {3, -2, 48});
  REQUIRE(tracker.touching());
  const auto hit = ball.index.nearest({3, -2, 48}, 10);
  REQUIRE(hit);
  CHECK(hit->behind);
  CHECK(glm::distance(hit->position, tracker.proxy()) < 1e-3 * ball.scene.radius);
}

TEST_CASE("the nearest point is that of a pass over all points, at any distance, for clouds in pieces, after edits") {
  constexpr std::uint32_t kPieces = 9, kPerPiece = 400;
  PointCloud cloud;
  const auto place = [](std::uint32_t i) {  // small tilted sheets, far apart, on both sides of every plane of the axes
    const DVec3 up = randomDirection(i / kPerPiece), right = glm::normalize(glm::cross(up, DVec3(0.3, 0.5, 0.8)));
    const std::uint32_t k = i % kPerPiece;
    return Vec3(160.0 * randomDirection(50 + i / kPerPiece) + right * (0.5 * (k % 20)) +
                glm::cross(up, right) * (0.5 * (k / 20)));
  };
  for (std::uint32_t i = 0; i < kPieces * kPerPiece; ++i) {
    cloud.positions.push_back(place(i));
    cloud.normals.emplace_back(randomDirection(i / kPerPiece));
  }
  SurfaceIndex index = indexOf(cloud, {.radius = 2});
  std::vector<std::uint8_t> there(cloud.size(), 1);
  const auto judge = [&] {
    for (std::uint64_t i = 0; i < 300; ++i) {
      const DVec3 x = (i % 3 == 0 ? 20.0 : i % 3 == 1 ? 250.0 : 5000.0) * randomDirection(100 + i);
      std::uint32_t nearest = 0;
      double least = kEndless;
      for (std::uint32_t k = 0; k < cloud.size(); ++k) {
        const DVec3 d = DVec3(cloud.positions[k]) - x;
        if (there[k] && glm::dot(d, d) < least) least = glm::dot(d, d), nearest = k;
      }
      CAPTURE(i);
      const auto hit = index.nearest(x, kEndless);
      REQUIRE(hit);
      CHECK(hit->point == nearest);
      CHECK_FALSE(index.nearest(x, std::sqrt(least) - 4));
    }
  };
  judge();
  std::vector<PointState> states;
  for (std::uint32_t i = 0; i < 3 * kPerPiece; ++i) {  // one piece goes, one moves, one is halved
    const bool stays = i / kPerPiece == 1 || (i / kPerPiece == 2 && i % 2 == 0);
    if (i / kPerPiece == 1) cloud.positions[i] += Vec3(30, -20, 10);
    there[i] = stays;
    states.push_back({.position = cloud.positions[i], .gone = !stays, .number = i, .normal = cloud.normals[i]});
  }
  index.follow(states);
  judge();
}

TEST_CASE("an index that follows edits answers as one of the edited points, to the last bit") {
  const Scene scene = makeScene("sphere", 5'000);
  const SurfaceOptions options{.radius = scene.radius, .kind = SurfaceKind::sphere};
  SurfaceIndex index = indexOf(scene.cloud, options);
  PointCloud edited = scene.cloud;
  std::vector<std::uint8_t> there(edited.size(), 1);
  std::vector<PointState> states;
  const auto put = [&](std::uint32_t number, const Vec3& position, bool exists) {
    states.push_back({.position = position, .gone = !exists, .number = number, .normal = Vec3(0, 0, 1)});
    if (number == edited.size()) {
      edited.positions.emplace_back();
      edited.normals.emplace_back();
      there.push_back(0);
    }
    edited.positions[number] = position;
    edited.normals[number] = states.back().normal;
    there[number] = exists;
  };
  for (std::uint32_t i = 0; i < 5'000; ++i)  // the cap of the ball is pressed flat, and half of it is gone
    if (edited.positions[i].z > 40) put(i, {edited.positions[i].x, edited.positions[i].y, 40}, i % 2 == 0);
  for (int i = 0; i < 400; ++i) put(static_cast<std::uint32_t>(edited.size()), {i % 20 - 10, i / 20 - 10, 40.0f}, true);
  index.follow(states);
  const SurfaceIndex fresh(edited.positions, edited.normals, there, options, 1);
  int hits = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const DVec3 from = 90.0 * randomDirection(i);
    for (const bool asRay : {false, true}) {
      const auto one = asRay ? index.castRay(from, glm::normalize(-from), kEndless) : index.nearest(from, kEndless);
      const auto other = asRay ? fresh.castRay(from, glm::normalize(-from), kEndless) : fresh.nearest(from, kEndless);
      REQUIRE(one.has_value() == other.has_value());
      if (!one) continue;
      ++hits;
      CHECK(one->position == other->position);
      CHECK(one->normal == other->normal);
      CHECK(one->point == other->point);
    }
  }
  CHECK(hits > 150);
  const auto flat = index.castRay({1, 2, 90}, {0, 0, -1}, kEndless);
  REQUIRE(flat);
  CHECK(flat->position.z == within(40, 1e-3));
}

}  // namespace palpate::surface_index_test
