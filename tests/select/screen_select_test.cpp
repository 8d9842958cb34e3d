// Points in an outline of a picture, and on the first surface that it shows.
#include "engine/select/screen_select.hpp"

#include <doctest/doctest.h>

#include <ctime>

#include "engine/core/clock.hpp"
#include "tests/select/some_points.hpp"

namespace palpate::select_test {

namespace {

const DVec2 kSize_px{400, 300};
const std::vector<DVec2> kWhole{{0, 0}, {400, 0}, {400, 300}, {0, 300}};

// The winding number as a sum of angles.
bool isWound(std::span<const DVec2> corners, const DVec2& at) {
  double sum = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const DVec2 a = corners[k] - at, b = corners[(k + 1) % corners.size()] - at;
    sum += std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b));
  }
  return std::abs(sum) > 1;
}

/// Draws the points as discs, ray by ray.
DepthPicture drawn(std::span<const PointState> points, double radius, const Camera& camera, double shrink = 1) {
  DepthPicture picture{.depths = {},
                       .width = static_cast<std::uint32_t>(kSize_px.x / shrink),
                       .shrink = shrink,
                       .camera = camera,
                       .size_px = kSize_px};
  picture.depths.resize(picture.width * static_cast<std::size_t>(kSize_px.y / shrink));
  const double focal_px = camera.focal_px(kSize_px.y);
  for (const PointState& point : points) {
    const auto middle = camera.project(DVec3(point.position), kSize_px);
    if (!middle || point.gone) continue;
    const double reach = radius * focal_px / middle->z + shrink;
    const DVec2 from = glm::max(glm::floor((DVec2(*middle) - reach) / shrink), DVec2(0));
    const DVec2 to = glm::min(glm::ceil((DVec2(*middle) + reach) / shrink), DVec2(picture.width, picture.height()));
    for (double y = from.y; y < to.y; ++y)
      for (double x = from.x; x < to.x; ++x) {
        const DVec3 ray = camera.unproject(shrink * DVec2(x + 0.5, y + 0.5), 1, kSize_px) - camera.eye;
        const DVec3 normal(point.normal), place(point.position);
        const double depth = glm::dot(place - camera.eye, normal) / glm::dot(ray, normal);
        if (!(depth > 0) || glm::distance(camera.eye + depth * ray, place) > radius) continue;
        float& nearest = picture.depths[static_cast<std::size_t>(y) * picture.width + static_cast<std::size_t>(x)];
        if (nearest == 0 || static_cast<float>(depth) < nearest) nearest = static_cast<float>(depth);
      }
  }
  return picture;
}

bool isFront(const PointState& point, const Camera& camera) {
  return glm::dot(DVec3(point.normal), camera.eye - DVec3(point.position)) > 0;
}

PointBits all(std::span<const PointState> points) { return shownPoints(points, {}); }

}  // namespace

TEST_CASE("what an outline winds around is inside, also where it crosses itself") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-20, 420), y(-20, 320);
  std::size_t inside = 0, differing = 0;
  for (const std::size_t count : {3, 4, 5, 9, 40, 300}) {
    std::vector<DVec2> corners;
    for (std::size_t k = 0; k < count; ++k) corners.push_back(DVec2{x(random), y(random)});
    corners.push_back(corners.back());
    const ScreenOutline outline(corners);
    for (int i = 0; i < 2000; ++i) {
      const DVec2 at{x(random), y(random)};
      inside += isWound(corners, at);
      differing += outline.contains(at) != isWound(corners, at);
    }
  }
  CHECK(inside > 3000);
  CHECK(differing == 0);
}

TEST_CASE("outlines that enclose nothing contain nothing, and huge ones all") {
  const std::vector<DVec2> line{{10, 10}, {100, 10}, {50, 10}},
      huge{{-1e9, -1e9}, {1e9, -1e9}, {1e9, 1e9}, {-1e9, 1e9}};
  for (std::size_t count = 0; count <= 3; ++count)
    CHECK_FALSE(ScreenOutline(std::span(line).first(count)).contains({50, 10}));
  CHECK(ScreenOutline(huge).contains({3, 4}));
  CHECK_FALSE(ScreenOutline(huge).contains({3e9, 4}));
  CHECK_FALSE(ScreenOutline(huge).contains({std::nan(""), 4}));
}

TEST_CASE("the points in an outline are those that the camera projects into it, at any number of points") {
  const Camera camera{.eye = {0.4, 0.3, 2}, .nearDepth = 0.8};
  const std::vector<DVec2> corners{{90, 30}, {350, 80}, {240, 270}, {200, 110}, {60, 220}};
  const ScreenOutline outline(corners);
  for (const std::size_t count : {0, 1, 2, 63, 64, 65, 4097}) {
    const std::vector<PointState> points = scattered(count, 3);
    PointSet hidden;
    for (std::size_t i = 0; i < count; i += 3) hidden.set(i);
    const PointBits found = pointsInOutline(points, shownPoints(points, hidden), outline, camera, kSize_px, 2);
    REQUIRE(found.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto at = camera.project(DVec3(points[i].position), kSize_px);
      const bool expected = !points[i].gone && i % 3 != 0 && at && isWound(corners, DVec2(*at));
      CHECK(found.test(i) == expected);
    }
    CHECK(found == pointsInOutline(points, shownPoints(points, hidden), outline, camera, kSize_px, 1));
    if (count > 4000) CHECK(found.count() > 200);
  }
}

TEST_CASE("of a closed ball the first surface is the side that faces the eye, and nothing of the other") {
  const std::vector<PointState> points = ball(8000);
  const double spacing = std::sqrt(4 * 3.14159265 * 50 * 50 / 8000);
  for (const double shrink : {1.0, 2.0}) {
    CAPTURE(shrink);
    const Camera camera{.eye = {30, 60, 150}, .target = {0, 0, 0}, .nearDepth = 1};
    const DepthPicture picture = drawn(points, spacing, camera, shrink);
    const PointBits seen = firstSurface(points, all(points), picture, spacing);
    std::size_t front = 0, missed = 0;
    for (const PointState& point : points) {
      const bool is = isFront(point, camera);
      front += is;
      missed += is && !seen.test(point.number);
      CHECK_FALSE((!is && seen.test(point.number)));
    }
    CHECK(front > 2000);
    CHECK(missed <= front / 200);
  }
}

TEST_CASE("of a thin plate the first surface is the near sheet, whatever the normals say") {
  constexpr int kSide = 60;
  constexpr double kSpacing = 1;
  for (const DVec3& eye : {DVec3(0, 0, 110), DVec3(70, 30, 100), DVec3(120, 15, 70)})
    for (const char* normals : {"outwards", "inwards", "mixed", "none"}) {
      CAPTURE(eye.x);
      CAPTURE(std::string(normals));
      std::vector<PointState> points = plate(kSide);
      const Camera camera{.eye = eye, .target = {0, 0, 0}, .nearDepth = 1};
      const DepthPicture picture = drawn(points, 1, camera);
      std::mt19937 random(5);
      for (PointState& point : points) {
        if (std::string_view(normals) == "inwards" || (std::string_view(normals) == "mixed" && random() % 2))
          point.normal = -point.normal;
        if (std::string_view(normals) == "none") point.normal = Vec3(0);
      }
      const PointBits seen = firstSurface(points, all(points), picture, kSpacing);
      std::size_t front = 0, back = 0;
      for (const PointState& point : points) (point.number < kSide * kSide ? front : back) += seen.test(point.number);
      CHECK(front == kSide * kSide);
      // Of the far sheet only what the near one does not cover: a rim, where the plate is seen from the side.
      std::size_t uncovered = 0;
      for (const PointState& point : points) {
        const DVec3 place(point.position), way = camera.eye - place;
        const DVec3 above = place + (1.5 - place.z) / way.z * way;
        uncovered += place.z < 0 && std::max(std::abs(above.x), std::abs(above.y)) > 0.5 * (kSide - 1);
      }
      CHECK(back <= uncovered);
      if (eye.x == 0) CHECK(back == 0);
    }
}

TEST_CASE("where nothing is drawn nothing covers a point; points beside the picture or behind the eye are not seen") {
  const Camera camera{.eye = {0, 0, 10}, .target = {0, 0, 0}, .nearDepth = 1};
  const DepthPicture empty{
      .depths = std::vector<float>(400 * 300), .width = 400, .camera = camera, .size_px = kSize_px};
  const std::vector<PointState> points{pointAt({0, 0, 0}, 0), pointAt({0, 0, 20}, 1), pointAt({50, 0, 0}, 2),
                                       pointAt({1, 1, -5}, 3), pointAt({0, 0, 9.5}, 4)};
  CHECK(firstSurface(points, all(points), empty, 1).set() == [] {
    PointSet set = PointSet::range(0, 1);
    set.set(3);
    return set;
  }());
  CHECK(firstSurface({}, PointBits(), empty, 1).count() == 0);
  CHECK(firstSurface(points, all(points), DepthPicture{.camera = camera, .size_px = kSize_px}, 1).count() == 2);
}

TEST_CASE("a rectangle over a million points of a ball takes the near half in a picture's time") {
  const std::vector<PointState> points = ball(1'000'000);
  const double spacing = std::sqrt(4 * 3.14159265 * 50 * 50 / 1e6);
  const Camera camera{.eye = {0, 0, 150}, .target = {0, 0, 0}, .nearDepth = 1};
  const DepthPicture picture = drawn(points, spacing, camera);
  const Stopwatch since;
  const std::clock_t begin = std::clock();
  const PointBits inside = pointsInOutline(points, all(points), ScreenOutline(kWhole), camera, kSize_px);
  const PointBits seen = firstSurface(points, inside, picture, spacing);
  const PointSet set = seen.set();
  const double cpu_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  MESSAGE("1,000,000 points selected in " << 1e3 * since.elapsed_s() << " ms; CPU time of all threads " << cpu_ms
                                          << " ms");
  CHECK(inside.count() == points.size());
  std::size_t front = 0, wrong = 0;
  for (const PointState& point : points) {
    front += isFront(point, camera);
    wrong += !isFront(point, camera) && seen.test(point.number);
  }
  CHECK(wrong == 0);
  CHECK(set.count() <= front);
  CHECK(set.count() > front - front / 50);
}

}  // namespace palpate::select_test
