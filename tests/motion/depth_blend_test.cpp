// Surfaces blended from one depth frame to the next, against moving planes and spheres.
#include "engine/motion/depth_blend.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/depth_points.hpp"
#include "shaders/shared/motion.h"
#include "tests/motion/depth_scene.hpp"

namespace palpate::depth_blend_test {

namespace {

constexpr double kPeriod_s = 1.0 / 30, kNever = std::numeric_limits<double>::infinity();

/// A plane at a distance from the camera along its normal.
DepthFrame planeFrame(const DepthCamera& camera, const DVec3& normal, double distance) {
  DepthFrame frame;
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column)
      frame.depth_m.push_back(static_cast<float>(distance / glm::dot(normal, camera.placeAt(column, row, 1))));
  return frame;
}

struct Blended {
  DepthBlend blend;
  CloudFrame points;
  DepthPoints maker;
  std::vector<Vec3> normals = {};

  void follow(const DepthCamera& camera, const DepthFrame& before, const DepthFrame& frame, double since_s = kNever,
              const DVec3& origin = DVec3(0)) {
    maker.make(camera, before, origin, points);
    maker.normalsByPixel(points, before.depth_m.size(), normals);
    maker.make(camera, frame, origin, points);
    blend.follow(camera, {.frame = before, .normals = normals}, frame, origin, maker.pixels(),
                 {.between_s = kPeriod_s, .since_s = since_s, .lasts_s = kPeriod_s}, points);
    requireWhole(points, frame.depth_m.size());
    REQUIRE(maker.pixels().size() == points.size());
  }
  DVec3 placeAfter(std::size_t i, double time_s) const {
    return DVec3(points.positions[i]) + std::min(time_s, points.extrapolationLimit_s) * DVec3(points.velocities[i]);
  }
};

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

}  // namespace

TEST_CASE("a plane that steps starts at its old depth, moves evenly and ends at the observed depth") {
  const DepthCamera camera = smallCamera();
  for (const DVec3& normal : {DVec3(0, 0, 1), glm::normalize(DVec3(0.6, -0.3, 1)), glm::normalize(DVec3(-1.5, 0, 1))})
    for (const double step : {0.001, -0.004, 0.01}) {
      CAPTURE(normal.x);
      CAPTURE(step);
      Blended blended;
      blended.follow(camera, planeFrame(camera, normal, 0.5), planeFrame(camera, normal, 0.5 + step));
      REQUIRE(blended.points.size() > 15'000);
      std::size_t still = 0;
      for (std::size_t i = 0; i < blended.points.size(); ++i) {
        if (blended.points.velocities[i] == Vec3(0)) {
          ++still;  // outside the previous frame
          continue;
        }
        CHECK(std::abs(glm::dot(normal, blended.placeAfter(i, 0)) - 0.5) < 1e-6);
        CHECK(std::abs(glm::dot(normal, blended.placeAfter(i, 1)) - 0.5 - step) < 1e-6);
        CHECK(std::abs(glm::dot(normal, blended.placeAfter(i, 0.5 * kPeriod_s)) - 0.5 - 0.5 * step) < 1e-6);
      }
      CHECK(still < blended.points.size() / 10);
      CHECK_FALSE(blended.points.slides);  // tangentially
    }
}

TEST_CASE("static objects stay at rest while the camera moves, at any origin of the world") {
  const DepthCamera camera = smallCamera();
  for (const DVec3& at : {DVec3(0), DVec3(5000, -3000, 200)}) {
    const DepthScene scene = tableScene(at);
    DepthFrame before = scene.frame(camera, onArc(at, 0.8, 0.3)), frame = scene.frame(camera, onArc(at, 0.8, 0.31));
    Blended blended;
    blended.follow(camera, before, frame, kNever, at);
    std::vector<double> ways;
    for (std::size_t i = 0; i < blended.points.size(); ++i)
      ways.push_back(kPeriod_s * std::abs(glm::dot(blended.points.velocities[i], blended.points.normals[i])));
    CHECK(median(ways) < 2e-6);
    std::ranges::sort(ways);
    CHECK(ways[ways.size() * 98 / 100] < 5e-4);  // except for the rims of the objects on the table
  }
}

TEST_CASE("normals start as observed before, rotate evenly and end as observed now") {
  const DepthCamera camera = smallCamera();
  const DVec3 first = glm::normalize(DVec3(0.3, 0, 1)), second = glm::normalize(DVec3(0.2, 0.2, 1));
  Blended blended;
  blended.follow(camera, planeFrame(camera, first, 0.5), planeFrame(camera, second, 0.5));
  std::size_t turned = 0;
  for (std::size_t i = 0; i < blended.points.size(); ++i) {
    if (blended.points.turns[i] == Vec3(0)) continue;
    ++turned;
    const Vec3 normal = blended.points.normals[i], turn = blended.points.turns[i];
    CHECK(glm::distance(DVec3(normal), -first) < 2e-4);
    CHECK(glm::distance(DVec3(shared::normalAfter(normal, turn, static_cast<float>(kPeriod_s))), -second) < 2e-4);
    const DVec3 halfWay(shared::normalAfter(normal, turn, static_cast<float>(0.5 * kPeriod_s)));
    CHECK(glm::distance(halfWay, glm::normalize(-first - second)) < 2e-4);
  }
  CHECK(turned > blended.points.size() * 9 / 10);
}

TEST_CASE("points of a moving sphere start on the old sphere and end on the new one") {
  const DepthCamera camera = smallCamera();
  const DVec3 from(0, 0, 0), to(0.004, -0.012, 0.003);
  const CameraPose pose = lookingAt({0, -0.6, 0.1}, DVec3(0));
  DepthScene before, after;
  before.add("sphere", 0.12, from);
  after.add("sphere", 0.12, to);
  Blended blended;
  blended.follow(camera, before.frame(camera, pose), after.frame(camera, pose));
  std::vector<double> offBefore, offAfter;
  for (std::size_t i = 0; i < blended.points.size(); ++i) {
    if (blended.points.velocities[i] == Vec3(0)) continue;
    offBefore.push_back(std::abs(glm::distance(blended.placeAfter(i, 0), from) - 0.06));
    offAfter.push_back(std::abs(glm::distance(blended.placeAfter(i, 1), to) - 0.06));
  }
  CHECK(offBefore.size() > blended.points.size() * 9 / 10);
  CHECK(median(offBefore) < 5e-4);  // of a displacement of 13 mm
  std::ranges::sort(offAfter);
  CHECK(offAfter.back() < 1e-5);
}

TEST_CASE("an early frame continues from the position reached so far, and a late one from the end") {
  const DepthCamera camera = smallCamera();
  const DVec3 ahead(0, 0, 1);
  const DepthFrame first = planeFrame(camera, ahead, 0.5), second = planeFrame(camera, ahead, 0.504),
                   third = planeFrame(camera, ahead, 0.506);
  for (const double since_s : {0.25 * kPeriod_s, kPeriod_s, 3 * kPeriod_s}) {
    Blended blended;
    blended.follow(camera, first, second);
    const double reached = 0.5 + 0.004 * std::min(1.0, since_s / kPeriod_s);
    blended.follow(camera, second, third, since_s);
    for (std::size_t i = 0; i < blended.points.size(); i += 97) {
      if (blended.points.velocities[i] == Vec3(0)) continue;
      CHECK(std::abs(blended.placeAfter(i, 0).z - reached) < 1e-6);
      CHECK(std::abs(blended.placeAfter(i, 1).z - 0.506) < 1e-6);
    }
  }
}

TEST_CASE("points not observed before stay at rest: too far away, outside the image or without depth") {
  const DepthCamera camera = smallCamera();
  const DVec3 ahead(0, 0, 1);
  Blended blended;
  const auto isStill = [&] {
    return std::ranges::all_of(blended.points.velocities, [](const Vec3& v) { return v == Vec3(0); });
  };
  blended.follow(camera, planeFrame(camera, ahead, 0.5), planeFrame(camera, ahead, 0.6));
  CHECK(isStill());
  CHECK(std::abs(blended.points.positions[0].z - 0.6f) < 1e-6f);
  DepthFrame nothing = planeFrame(camera, ahead, 0.5);
  for (const float depth :
       {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::ranges::fill(nothing.depth_m, depth);
    blended.follow(camera, nothing, planeFrame(camera, ahead, 0.5));
    CHECK(isStill());
  }
  DepthFrame aside = planeFrame(camera, ahead, 0.5);
  aside.pose = CameraPose{.centre = {10, 0, 0}};
  blended.follow(camera, aside, planeFrame(camera, ahead, 0.5));
  CHECK(isStill());
  aside.pose = CameraPose{.centre = {0, 0, 10}};  // the camera looked elsewhere
  blended.follow(camera, aside, planeFrame(camera, ahead, 0.5));
  CHECK(isStill());
}

TEST_CASE("the first frame does not move") {
  const DepthCamera camera = smallCamera();
  CloudFrame points;
  points.extrapolationLimit_s = 7;
  points.velocities.resize(3);
  DepthBlend blend;
  DepthPoints().make(camera, planeFrame(camera, {0, 0, 1}, 0.5), DVec3(0), points);
  blend.begin(points);
  CHECK(points.velocities.empty());
  CHECK(points.extrapolationLimit_s == kMaxPointsAge_s);
}

}  // namespace palpate::depth_blend_test
