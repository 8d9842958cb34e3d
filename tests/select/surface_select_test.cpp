// Points in balls, connected points, rims of selections and points that look alike, against all pairs.
#include "engine/select/surface_select.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/near.hpp"
#include "tests/select/some_points.hpp"

namespace palpate::select_test {

namespace {

constexpr std::size_t kCounts[]{0, 1, 2, 63, 64, 65, 700};

double distance(const PointState& a, const PointState& b) {
  return glm::distance(DVec3(a.position), DVec3(b.position));
}

PointBits everyThird(std::size_t count) {
  return PointBits::where(count, 1, [](std::size_t i) { return i % 3 == 0; });
}

void checkIs(const PointBits& found, const std::function<bool(std::size_t)>& expected) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < found.size(); ++i) differing += found.test(i) != expected(i);
  CHECK(differing == 0);
}

}  // namespace

TEST_CASE("bits and sets of points are the same, at any number of points") {
  for (const std::size_t count : {0, 1, 63, 64, 65, 4095, 4096, 4097, 20000}) {
    CAPTURE(count);
    PointSet set = PointSet::range(count / 4, count / 2 + 5000);
    if (count > 7000) set.set(6999, !set.test(6999));
    const PointBits bits(set, count);
    PointSet expected;
    for (std::size_t i = 0; i < count; ++i)
      if (set.test(i)) expected.set(i);
    CHECK(bits.set() == expected);
    CHECK(bits.count() == expected.count());
    CHECK(PointBits(bits.set(), count) == bits);
    const PointBits all = PointBits::where(count, 2, [](std::size_t) { return true; });
    CHECK((all - bits).count() + bits.count() == count);
    CHECK(((all - bits) & bits).count() == 0);
    CHECK(((all - bits) | bits) == all);
    CHECK(all.set() == PointSet::range(0, count));
  }
}

TEST_CASE("rims and means of locks are those of all pairs, and sharpened rims become hard where they were half") {
  for (const std::size_t count : kCounts)
    for (const double radius : {0.0, 0.06, 0.3, 5.0}) {
      CAPTURE(count);
      CAPTURE(radius);
      const std::vector<PointState> points = scattered(count, 11, DVec3(4e3, -3e3, 1e3));
      const PointBits among = shownPoints(points, {}), of = everyThird(count) & among;
      const std::vector<std::uint8_t> rim = withRim(points, among, of, radius, 2);
      const std::vector<std::uint8_t> mean = softened(points, rim, radius, 2);
      REQUIRE(rim.size() == count);
      REQUIRE(mean.size() == count);
      for (std::size_t i = 0; i < count; ++i) {
        double nearest = of.test(i) ? 0 : 1, sum = rim[i], total = 1;
        for (std::size_t k = 0; k < count && radius > 0; ++k) {
          const double r = distance(points[i], points[k]) / radius;
          if (of.test(k) && among.test(i)) nearest = std::min(nearest, r);
          if (k == i || points[k].gone || points[i].gone || !(r < 1)) continue;
          sum += (1 - r * r) * (1 - r * r) * rim[k];
          total += (1 - r * r) * (1 - r * r);
        }
        CHECK(rim[i] == within(255 * (1 - nearest * nearest * (3 - 2 * nearest)), 0.51));
        CHECK(mean[i] == within(rim[i] == 255 ? 255 : sum / total, 0.51));
      }
    }
  std::vector<std::uint8_t> weights;
  for (int weight = 0; weight < 256; ++weight) weights.push_back(static_cast<std::uint8_t>(weight));
  CHECK(std::ranges::is_sorted(sharpened(weights)));
  for (int k = 0; k < 8; ++k) weights = sharpened(weights);
  for (std::size_t weight = 0; weight < 256; ++weight) CHECK(weights[weight] == (weight < 128 ? 0 : 255));
}

TEST_CASE("points in balls, and what grows and shrinks, are those of all pairs") {
  for (const DVec3& middle : {DVec3(0), DVec3(4e5, -3e5, 1e5)})
    for (const std::size_t count : kCounts)
      for (const double radius : {0.0, 0.06, 0.3, 5.0}) {
        CAPTURE(count);
        CAPTURE(radius);
        const std::vector<PointState> points = scattered(count, 11, middle);
        const PointBits among = shownPoints(points, {}), of = everyThird(count) & among;
        const auto isNear = [&](std::size_t i, auto&& isOf) {
          for (std::size_t j = 0; j < count; ++j)
            if (isOf(j) && distance(points[i], points[j]) < radius) return true;
          return false;
        };
        checkIs(grown(points, among, of, radius, 2), [&](std::size_t i) {
          return of.test(i) || (among.test(i) && isNear(i, [&](std::size_t j) { return of.test(j); }));
        });
        checkIs(shrunk(points, among, of, radius, 2), [&](std::size_t i) {
          return of.test(i) && !isNear(i, [&](std::size_t j) { return among.test(j) && !of.test(j); });
        });
        std::vector<Vec3> centres;
        for (std::size_t j = 0; j < count; j += 50) centres.push_back(points[j].position);
        checkIs(pointsInBalls(points, among, centres, radius, 2),
                [&](std::size_t i) { return among.test(i) && isNear(i, [](std::size_t j) { return j % 50 == 0; }); });
      }
  CHECK(pointsInBalls(ball(100), PointBits(100), {}, 5).count() == 0);
}

TEST_CASE("weights in balls fall off towards their rims, from the nearest one, as a brush does") {
  const std::vector<PointState> points = scattered(300, 11);
  const PointBits among = shownPoints(points, {});
  const std::vector<Vec3> centres{points[0].position, points[50].position};
  for (const std::uint32_t falloff : {0u, 1u, 5u}) {
    const std::vector<std::uint8_t> weights = weightsInBalls(points, among, centres, 0.3, falloff, 2);
    REQUIRE(weights.size() == points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double r = std::min(distance(points[i], points[0]), distance(points[i], points[50])) / 0.3;
      const double expected = r < 1 && among.test(i) ? 255 * std::pow(1 - r * r, falloff) : 0;
      CHECK(std::abs(weights[i] - expected) <= 0.501);
    }
  }
  CHECK(std::ranges::count(weightsInBalls(points, among, {}, 0.3, 1), 0) == 300);
}

TEST_CASE("connected points are those that steps of the reach lead to") {
  for (const std::size_t count : kCounts)
    for (const double reach : {0.0, 0.12, 0.2, 5.0}) {
      CAPTURE(count);
      CAPTURE(reach);
      const std::vector<PointState> points = scattered(count, 17);
      const PointBits among = shownPoints(points, {});
      PointBits seeds(count);
      for (const std::size_t seed : {0, 40, 5})  // 5 does not exist
        if (seed < count) seeds.set(seed);
      std::vector<bool> reached(count);
      for (std::size_t i = 0; i < count; ++i) reached[i] = seeds.test(i) && among.test(i);
      for (bool goesOn = true; goesOn;) {
        goesOn = false;
        for (std::size_t i = 0; i < count; ++i)
          for (std::size_t j = 0; reached[i] && j < count; ++j)
            if (!reached[j] && among.test(j) && distance(points[i], points[j]) < reach) goesOn = reached[j] = true;
      }
      checkIs(connectedWith(points, among, seeds, reach, 2), [&](std::size_t i) { return bool{reached[i]}; });
    }
}

TEST_CASE("a flood over the near sheet of a plate does not reach the far one, nor past a crease") {
  const std::vector<PointState> points = plate(40);
  PointBits seed(points.size());
  seed.set(820);
  const PointBits among = shownPoints(points, {});
  CHECK(connectedWith(points, among, seed, 2.5).count() == 1600);
  CHECK(connectedWith(points, among, seed, 3.5).count() == 3200);
  const PointBits alike = pointsLike(points, among, points[820], {.normal_deg = 15, .color = {}});
  CHECK(connectedWith(points, alike, seed, 3.5).count() == 1600);
}

TEST_CASE("points are alike by the angle of their normals and by each of their colours") {
  std::vector<PointState> points;
  for (int angle = 0; angle <= 180; ++angle)
    points.push_back(pointAt({0, 0, 0}, points.size(),
                             {std::sin(angle * 0.017453292519943295), 0, std::cos(angle * 0.017453292519943295)}));
  points.push_back(pointAt({0, 0, 0}, points.size(), DVec3(0)));
  points.push_back(pointAt({0, 0, 0}, points.size(), DVec3(std::nan(""))));
  const PointBits among = shownPoints(points, {});
  checkIs(pointsLike(points, among, points[40], {.normal_deg = 15.5, .color = {}}),
          [](std::size_t i) { return i >= 25 && i <= 55; });
  CHECK(pointsLike(points, among, points[181], {.normal_deg = 90, .color = {}}).count() == 0);
  CHECK(pointsLike(points, among, points[182], {.normal_deg = 90, .color = {}}).count() == 0);
  points.resize(100);
  for (std::size_t i = 0; i < 100; ++i)
    points[i].color = packedColor(
        {static_cast<std::uint8_t>(i < 50 ? 100 + i : 100), 7, static_cast<std::uint8_t>(i < 50 ? 9 : 9 + i), 255});
  const PointBits first = shownPoints(points, {});
  CHECK(pointsLike(points, first, points[0], {.normal_deg = {}, .color = 10}).count() == 11);
  CHECK(pointsLike(points, first, points[0], {.normal_deg = {}, .color = 0}).count() == 1);
  CHECK(pointsLike(points, first, points[0], {.normal_deg = {}, .color = 255}).count() == 100);
}

TEST_CASE("the nearest point is one of those that are meant") {
  const std::vector<PointState> points = scattered(300, 23);
  const PointBits among = shownPoints(points, PointSet::range(0, 100));
  for (std::size_t k = 0; k < 300; k += 7) {
    const DVec3 at(points[k].position);
    const auto nearest = nearestPoint(points, among, at);
    REQUIRE(nearest.has_value());
    CHECK(among.test(*nearest));
    for (std::size_t i = 0; i < 300; ++i)
      if (among.test(i)) CHECK(distance(points[i], points[k]) >= distance(points[*nearest], points[k]));
  }
  CHECK_FALSE(nearestPoint(points, PointBits(300), DVec3(0)).has_value());
}

}  // namespace palpate::select_test
