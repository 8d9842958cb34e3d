// Points of depth frames against the observed shapes.
#include "engine/motion/depth_points.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/core/error.hpp"
#include "engine/motion/cloud_source.hpp"
#include "tests/motion/depth_scene.hpp"

namespace palpate::depth_points_test {

namespace {

constexpr DepthCamera kCamera{.width = 96, .height = 72, .fx = 80, .fy = 82, .cx = 47.5, .cy = 35.5};

CloudFrame pointsOf(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin = DVec3(0)) {
  CloudFrame points;
  DepthPoints().make(camera, frame, origin, points);
  requireWhole(points, std::size_t{camera.width} * camera.height);
  return points;
}

DepthFrame flat(const DepthCamera& camera, float depth_m) {
  return {.depth_m = std::vector<float>(std::size_t{camera.width} * camera.height, depth_m)};
}

}  // namespace

TEST_CASE("points of an observed sphere and torus lie on them, with normals that face the camera") {
  for (const char* name : {"sphere", "torus"})
    for (const DVec3& center : {DVec3(0, 0, 0), DVec3(1, -2, 3)}) {
      CAPTURE(name);
      DepthScene scene;
      scene.add(name, 1.0, center);
      const CameraPose pose = lookingAt(center + DVec3(0.4, -1.6, 0.9), center);
      const CloudFrame points = pointsOf(kCamera, scene.frame(kCamera, pose));
      REQUIRE(points.size() > 400);
      double farthest = 0, turned = 0;
      std::vector<double> wrong_deg;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const DVec3 place(points.positions[i]), normal(points.normals[i]);
        const SurfacePoint truth = scene.closest(place);
        farthest = std::max(farthest, glm::distance(place, truth.position));
        CHECK(std::abs(glm::length(normal) - 1) < 1e-6);
        turned = std::max(turned, glm::dot(normal, glm::normalize(place - pose.centre)));
        // A rim seen edge-on has too few pixels for a good normal.
        if (glm::dot(truth.normal, glm::normalize(place - pose.centre)) < -0.3)
          wrong_deg.push_back(angleBetween_deg(normal, truth.normal));
      }
      CHECK(farthest < 2e-6);
      CHECK(turned <= 0);
      std::ranges::sort(wrong_deg);
      CHECK(wrong_deg[wrong_deg.size() / 2] < 1);
      CHECK(wrong_deg.back() < 20);
    }
}

TEST_CASE("a plane has exact normals up to its border, from any view") {
  for (const DVec3& eye : {DVec3(0, 0, 2), DVec3(1.5, 0.4, 1), DVec3(-0.3, 2, 0.8)}) {
    DepthScene scene;
    scene.add("plane", 40, DVec3(0));
    const CameraPose pose = lookingAt(eye, DVec3(0));
    const CloudFrame points = pointsOf(kCamera, scene.frame(kCamera, pose));
    CHECK(points.size() > 5000);
    for (const Vec3& normal : points.normals) CHECK(glm::distance(normal, Vec3(0, 0, 1)) < 1e-4f);
  }
  CHECK(pointsOf(kCamera, flat(kCamera, 1)).size() == 96 * 72);
}

TEST_CASE("points are in the camera's axes without a pose, and relative to the origin in the world's axes with one") {
  const DepthFrame frame = flat(kCamera, 2);
  const CloudFrame seen = pointsOf(kCamera, frame);
  CHECK(glm::distance(seen.positions[0], Vec3(2 * -47.5 / 80, 2 * -35.5 / 82, 2)) < 1e-6f);
  CHECK(seen.normals[0] == Vec3(0, 0, -1));
  CHECK(seen.colors.empty());
  CHECK(seen.velocities.empty());

  DepthFrame placed = frame;
  const DVec3 far(1e6, -2e6, 5e5);
  placed.pose = CameraPose{.turn = glm::normalize(DQuat(0.3, 0.5, -0.1, 0.7)), .centre = far};
  const CloudFrame points = pointsOf(kCamera, placed, far);
  const DVec3 corner(seen.positions.back());
  CHECK(glm::distance(DVec3(points.positions.back()), placed.pose->turn * corner) < 1e-6);
  CHECK(glm::distance(DVec3(points.normals[7]), placed.pose->turn * DVec3(0, 0, -1)) < 1e-6);
}

TEST_CASE("normals do not extend over a depth jump, and an isolated pixel gives no point") {
  // Two planes at 1 m and 1.5 m, and an isolated pixel in front of the first.
  DepthFrame frame = flat(kCamera, 1);
  for (std::size_t row = 0; row < 72; ++row)
    for (std::size_t column = 50; column < 96; ++column) frame.depth_m[row * 96 + column] = 1.5f;
  const std::size_t speck = 30 * 96 + 20;
  frame.depth_m[speck] = 0.6f;
  const CloudFrame points = pointsOf(kCamera, frame);
  CHECK(points.size() == 96 * 72 - 1);
  for (std::size_t i = 0; i < points.size(); ++i) CHECK(glm::distance(points.normals[i], Vec3(0, 0, -1)) < 1e-6f);
}

TEST_CASE("a column of pixels, a single pixel and an image without depth give no points") {
  for (const auto& [width, height] : {std::pair{1u, 1u}, std::pair{1u, 9u}, std::pair{9u, 1u}}) {
    const DepthCamera camera{.width = width, .height = height, .fx = 9, .fy = 9};
    CHECK(pointsOf(camera, flat(camera, 1)).size() == 0);
  }
  const DepthCamera two{.width = 2, .height = 2, .fx = 9, .fy = 9};
  CHECK(pointsOf(two, flat(two, 1)).size() == 4);
  CHECK(pointsOf(kCamera, flat(kCamera, 0)).size() == 0);
}

TEST_CASE("invalid depths are skipped pixel by pixel, and frames of a wrong size are refused") {
  DepthFrame frame = flat(kCamera, 1);
  const float infinite = std::numeric_limits<float>::infinity();
  const std::size_t places[] = {196, 400, 602, 1000, 2000};
  const float values[] = {std::nanf(""), infinite, -infinite, -1, 1e30f};
  for (std::size_t k = 0; k < 5; ++k) frame.depth_m[places[k]] = values[k];
  frame.colors.assign(frame.depth_m.size(), {1, 2, 3});
  frame.colors[197] = {4, 5, 6};
  const CloudFrame points = pointsOf(kCamera, frame);
  CHECK(points.size() == 96 * 72 - 5);
  CHECK(points.colors.size() == points.size());
  CHECK(points.colors[196] == std::array<std::uint8_t, 3>{4, 5, 6});  // the pixel before it has no point
  CloudFrame none;
  frame.colors.pop_back();
  CHECK_THROWS_AS(DepthPoints().make(kCamera, frame, DVec3(0), none), Error);
  frame.colors.clear();
  frame.depth_m.pop_back();
  CHECK_THROWS_WITH_AS(DepthPoints().make(kCamera, frame, DVec3(0), none),
                       "frame 0 has 6911 depths and 0 colours, and the camera 96 x 72 pixels", Error);
}

TEST_CASE("points depend neither on the number of threads nor on the previous frame") {
  DepthFrame frame = flat(kCamera, 1);
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i) {
    frame.depth_m[i] += 0.003f * static_cast<float>(i % 7);
    if (i % 11 == 3) frame.depth_m[i] = 0;
  }
  frame.colors.resize(frame.depth_m.size(), {9, 8, 7});
  DepthPoints one;
  CloudFrame expected;
  one.make(kCamera, frame, DVec3(0), expected);
  CHECK(expected.size() > 1000);
  for (const unsigned threads : {2u, 3u, 7u, 200u}) {
    CAPTURE(threads);
    DepthPoints several(threads);
    CloudFrame points;
    several.make(kCamera, flat(kCamera, 2), DVec3(0), points);
    several.make(kCamera, frame, DVec3(0), points);
    CHECK(points.positions == expected.positions);
    CHECK(points.normals == expected.normals);
    CHECK(points.colors == expected.colors);
    CHECK(several.pixels() == one.pixels());
  }
}

}  // namespace palpate::depth_points_test
