#include "engine/render/camera.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <random>

#include "engine/core/error.hpp"
#include "tests/near.hpp"

namespace palpate::camera_test {

namespace {

PointCloud boxCloud(const Vec3& center, const Vec3& half, std::size_t count = 500) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i)
    cloud.positions.push_back(center + half * Vec3{unit(random), unit(random), unit(random)});
  return cloud;
}

}  // namespace

TEST_CASE("the fitted camera sees every point and fills the picture") {
  for (const double aspect : {0.3, 1.0, 16.0 / 9, 4.0}) {
    for (const Vec3& half : {Vec3(1, 1, 1), Vec3(3, 0.2f, 1), Vec3(0.1f, 5, 0.1f), Vec3(0, 0, 2), Vec3(1, 0, 0)}) {
      for (const double fov_deg : {10.0, 45.0, 120.0}) {
        const PointCloud cloud = boxCloud(Vec3(-7, 3, 11), half);
        const DVec2 size(800 * aspect, 800);
        const Camera camera = Camera::fitting(cloud, aspect, fov_deg);
        DVec2 low(1), high(0);
        for (const Vec3& p : cloud.positions) {
          const auto place = camera.project(p, size);
          REQUIRE(place);
          low = glm::min(low, DVec2(*place) / size);
          high = glm::max(high, DVec2(*place) / size);
        }
        CHECK(std::min(low.x, low.y) >= 0);
        CHECK(std::max(high.x, high.y) <= 1);
        const DVec2 fill = high - low;
        if (half.x > 0) CHECK(std::max(fill.x, fill.y) > (fov_deg < 100 ? 0.85 : 0.3));
      }
    }
  }
}

TEST_CASE("the fitted camera is in front and a little above") {
  const Camera camera = Camera::fitting(Bounds{DVec3(-1), DVec3(1)}, 1.5);
  CHECK(camera.eye.z > 2);
  CHECK(camera.eye.x == within(0, 1e-6));
  CHECK(camera.eye.y > 0.2);
  CHECK(camera.eye.y < 0.5 * camera.eye.z);
  CHECK(camera.nearDepth > 0);
  CHECK(camera.nearDepth < depthRangeOf(camera, {DVec3(-1), DVec3(1)}).x);
  CHECK(camera.farDepth > depthRangeOf(camera, {DVec3(-1), DVec3(1)}).y);
}

TEST_CASE("the fitted camera shows the same view for every up axis") {
  const PointCloud cloud = boxCloud(Vec3(2, -1, 4), Vec3(3, 2, 1));
  const DVec2 size(900, 600);
  const Camera upright = Camera::fitting(cloud, 1.5);
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    const DVec3 y = directionOf(up), z = frontOf(up), x = glm::cross(y, z);
    PointCloud turned;
    for (const Vec3& p : cloud.positions)
      turned.positions.emplace_back(double{p.x} * x + double{p.y} * y + double{p.z} * z);
    const Camera camera = Camera::fitting(turned, 1.5, 45, {.up = up});
    const Camera boxed = Camera::fitting(boundsOf(turned), 1.5, 45, up);
    CHECK(glm::distance(boxed.axes().up, camera.axes().up) < 1e-9);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const auto expected = upright.project(cloud.positions[i], size), seen = camera.project(turned.positions[i], size);
      REQUIRE(seen);
      CHECK(glm::distance(*seen, *expected) < 1e-3);
    }
  }
}

TEST_CASE("the discs of a few points fit into the picture") {
  const DVec2 size(900, 600);
  PointCloud few;
  few.positions = {Vec3(0), Vec3(1, 2, 0), Vec3(-1, 0, 1)};
  for (const PointCloud& cloud : {few, PointCloud{.positions = {Vec3(5, 6, 7)}}}) {
    const double margin = 0.4;
    const Camera camera = Camera::fitting(cloud, 1.5, 45, {.margin = margin});
    for (const Vec3& p : cloud.positions)
      for (const DVec3& aside : {camera.axes().right, camera.axes().up, camera.axes().forward})
        for (const double sign : {-1.0, 1.0}) {
          const auto place = camera.project(DVec3(p) + sign * margin * aside, size);
          REQUIRE(place);
          CHECK(std::min(place->x, place->y) >= 0);
          CHECK(place->x <= size.x);
          CHECK(place->y <= size.y);
        }
    // But not much farther than necessary.
    CHECK(glm::distance(camera.eye, camera.target) < 20 * margin);
  }
}

TEST_CASE("flat models are viewed from higher up") {
  const auto elevation = [](const DVec3& half) { return -Camera::fitting(Bounds{-half, half}, 1.5).axes().forward.y; };
  CHECK(elevation({1, 1, 1}) == near(elevation({1, 0.31, 1}), 1e-6));
  CHECK(elevation({1, 0.1, 1}) > elevation({1, 0.2, 1}) + 0.05);
  CHECK(elevation({1, 0, 1}) > 0.6);
  CHECK(elevation({1, 0, 1}) < 0.8);
}

TEST_CASE("one looks into a room from above") {
  const auto elevation = [&](const Vec3& half, bool fromAbove) {
    return -Camera::fitting(boxCloud(Vec3(0), half), 1.5, 45, {.fromAbove = fromAbove}).axes().forward.y;
  };
  CHECK(elevation(Vec3(1), false) < 0.3);
  CHECK(elevation(Vec3(1), true) == near(0.5, 1e-6));
  CHECK(elevation({1, 0, 1}, true) == elevation({1, 0, 1}, false));
}

TEST_CASE("points outside the shown box do not widen the view, and are drawn") {
  PointCloud cloud = boxCloud(Vec3(0), Vec3(1));
  const Bounds box = boundsOf(cloud);
  const Camera camera = Camera::fitting(cloud, 1.5);
  cloud.positions.emplace_back(0, 0, -40);
  cloud.positions.emplace_back(30, 0, 0);
  const Camera framed = Camera::fitting(cloud, 1.5, 45, {.shown = box});
  CHECK(glm::distance(framed.eye, camera.eye) < 1e-6);
  CHECK(framed.farDepth > depthRangeOf(framed, boundsOf(cloud)).y);
  CHECK(Camera::parse("", cloud, 1.5, {.shown = box}).eye == framed.eye);
  CHECK(glm::distance(Camera::fitting(cloud, 1.5).eye, camera.eye) > 5);
  cloud.positions.emplace_back(1e6f, 0, 0);
  CHECK(Camera::fitting(cloud, 1.5, 45, {.shown = box}).nearDepth <= camera.nearDepth);
  CHECK(Camera::parse("", cloud, 1.5, {.shown = box}).nearDepth <= camera.nearDepth);
}

TEST_CASE("the camera fits an empty cloud and a single point") {
  PointCloud cloud;
  CHECK(isFinite(Camera::fitting(cloud, 1).eye));
  cloud.positions = {Vec3(5, 6, 7)};
  const auto place = Camera::fitting(cloud, 1).project(DVec3(5, 6, 7), {100, 100});
  REQUIRE(place);
  CHECK(place->x == near(50, 1e-6));
  CHECK(place->y == near(50, 1e-6));
}

TEST_CASE("a camera is parsed word by word, and missing values are fitted") {
  PointCloud cloud = boxCloud(Vec3(0), Vec3(1));
  cloud.origin = {100, 200, 300};
  const Camera fitted = Camera::fitting(cloud, 1.5);
  const Camera none = Camera::parse("  ", cloud, 1.5);
  CHECK(none.eye == fitted.eye);
  const Camera all = Camera::parse("fov=30 eye=100,200,305 up=1,1e-1,0 target=100,200.5,300", cloud, 1.5);
  CHECK(all.eye == DVec3(0, 0, 5));
  CHECK(all.target == DVec3(0, 0.5, 0));
  CHECK(all.up == DVec3(1, 0.1, 0));
  CHECK(all.fov_deg == 30);
  const Camera eye = Camera::parse("eye=109,200,300", cloud, 1.5);
  CHECK(eye.target == fitted.target);
  const Camera target = Camera::parse("target=101,200,300", cloud, 1.5);
  CHECK(glm::distance(target.eye - target.target, fitted.eye - fitted.target) < 1e-9);
  CHECK(isFinite(Camera::parse("eye=100,209,300 target=100,200,300", cloud, 1.5).axes().right));
}

TEST_CASE("an invalid camera is refused with the word in question") {
  const PointCloud cloud = boxCloud(Vec3(0), Vec3(1));
  for (const auto& [text, word] :
       std::vector<std::array<std::string, 2>>{{"eye=1,2", "eye=1,2"},
                                               {"eye=1,2,3,4", "eye=1,2,3,4"},
                                               {"eye=1,x,3", "'x'"},
                                               {"eye=1,nan,3", "'nan'"},
                                               {"eye=1,,3", "''"},
                                               {"eye", "three numbers"},
                                               {"fov=0", "fov=0"},
                                               {"fov=180", "fov=180"},
                                               {"fov=1,2", "'1,2'"},
                                               {"zoom=3", "zoom=3"},
                                               {"fov=30 fov=40", "given twice"},
                                               {"up=0,0,0", "up"},
                                               {"eye=0,0,9 target=0,0,0 up=0,0,2", "up"},
                                               {"eye=1,2,3 target=1,2,3", "same point"},
                                               {"ortho=0", "above 0"},
                                               {"ortho=wide", "not a number"},
                                               {"ortho=1 ortho", "twice"},
                                               {"isometric=1", "not known; known are eye=x,y,z"},
                                               {"top back", "given twice"}}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(Camera::parse(text, cloud, 1), doctest::Contains(word.c_str()), UsageError);
  }
}

TEST_CASE("an orthographic camera shows lengths alike at all depths, and the model fills its picture") {
  const PointCloud cloud = boxCloud(Vec3(1, 2, 3), Vec3(2, 1, 4), 400);
  for (const DVec2 size : {DVec2(640, 480), DVec2(300, 600)})
    for (const char* text : {"ortho", "isometric", "ortho isometric"}) {
      CAPTURE(text);
      const Camera camera = Camera::parse(text, cloud, size.x / size.y);
      REQUIRE(camera.isOrthographic());
      DVec2 fill(0);
      for (const Vec3& p : cloud.positions) {
        const auto place = camera.project(DVec3(p), size);
        REQUIRE(place);
        fill = glm::max(fill, glm::abs(DVec2(*place) - 0.5 * size) / (0.5 * size));
        const auto behind = camera.project(DVec3(p) + 3.0 * camera.axes().forward, size);
        REQUIRE(behind);
        CHECK(glm::distance(DVec2(*behind), DVec2(*place)) < 1e-9);
      }
      CHECK(std::max(fill.x, fill.y) == near(0.9, 1e-9));
    }
  const Camera given = Camera::parse("eye=1,2,1003 target=1,2,3 ortho=8", cloud, 1);
  CHECK(given.height == 8);
  CHECK(given.pixelSize(17, 400) == near(0.02, 1e-12));
  CHECK(given.towardsViewer(DVec3(5, 6, 7)) == DVec3(0, 0, 1));
  const DVec3 isometric = Camera::parse("isometric", cloud, 1).axes().forward;
  for (int k = 0; k < 3; ++k) CHECK(isometric[k] == near(-1 / std::sqrt(3.0), 1e-12));
  // From a side one looks straight at it, and a plan and a view from below keep the right side on the right.
  const DVec3 front = frontOf(UpAxis::y), right = glm::cross(DVec3(0, 1, 0), front);
  for (const auto& [name, side] : kModelSides) {
    CAPTURE(name);
    for (const std::string more : {"", " ortho"}) {
      const Camera from = Camera::parse(std::string(name) + more, cloud, 1);
      CHECK(glm::distance(from.axes().forward, -directionTo(side, UpAxis::y, front)) < 1e-9);
      CHECK(from.isOrthographic() == (!more.empty() || side == ModelSide::isometric));
      if (side == ModelSide::top || side == ModelSide::bottom || side == ModelSide::front)
        CHECK(glm::distance(from.axes().right, right) < 1e-9);
      for (const Vec3& p : cloud.positions) {
        const auto place = from.project(DVec3(p), {100, 100});
        REQUIRE(place);
        CHECK(glm::all(glm::lessThan(glm::abs(DVec2(*place) - 50.0), DVec2(50))));
      }
    }
  }
  // An eye within the model moves back, so that nothing is cut off.
  const Camera within = Camera::parse("eye=1,2,3.5 target=1,2,3 ortho", cloud, 1);
  for (const Vec3& p : cloud.positions) CHECK(within.project(DVec3(p), {100, 100}));
}

TEST_CASE("the matrices agree with project()") {
  const PointCloud cloud = boxCloud(Vec3(1, 2, 3), Vec3(2), 50);
  const DVec2 size(640, 480);
  Camera camera = Camera::parse("eye=7,5,9 fov=50", cloud, size.x / size.y);
  DVec2 middle = size / 2.0;
  SUBCASE("with the target in the middle of the picture") {}
  SUBCASE("with the target elsewhere") {
    camera.center = {0.7, 0.4};
    middle = {448, 192};
  }
  SUBCASE("of an orthographic camera") {
    camera = Camera::parse("eye=7,5,9 ortho=5", cloud, size.x / size.y);
    camera.center = {0.7, 0.4};
    middle = {448, 192};
  }
  const auto target = camera.project(camera.target, size);
  REQUIRE(target);
  CHECK(glm::distance(DVec2(*target), middle) < 1e-9);
  const Mat4 matrix = camera.projection(size.x / size.y) * camera.view();
  for (const Vec3& p : cloud.positions) {
    const Vec4 clip = matrix * Vec4(p, 1);
    const auto place = camera.project(p, size);
    REQUIRE(place);
    CHECK(glm::distance(camera.unproject(DVec2(*place), place->z, size), DVec3(p)) < 1e-9);
    CHECK((0.5 + 0.5 * clip.x / clip.w) * size.x == within(place->x, 0.02));
    CHECK((0.5 + 0.5 * clip.y / clip.w) * size.y == within(place->y, 0.02));
    CHECK(clip.w == near(camera.divisorAt(place->z), 1e-5));
    CHECK(clip.z / clip.w > 0);
    CHECK(clip.z / clip.w < 1);
  }
}

}  // namespace palpate::camera_test
