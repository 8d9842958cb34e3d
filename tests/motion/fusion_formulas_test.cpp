// The formulas of fusion, shared by GLSL and C++, against known results written here.
#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <random>

#include "engine/motion/fusion.hpp"
#include "shaders/shared/icp.h"
#include "tests/motion/depth_scene.hpp"
#include "tests/near.hpp"

namespace palpate::fusion_formulas_test {

namespace {

using shared::uint;

// An image of a plane n.p = d in the camera's coordinates.
FrameImages planeImage(const DepthCamera& camera, const DVec3& normal, double offset) {
  FrameImages images{.camera = camera, .depths = {}, .colors = {}};
  for (std::uint32_t y = 0; y < camera.height; ++y)
    for (std::uint32_t x = 0; x < camera.width; ++x)
      images.depths.push_back(static_cast<float>(offset / glm::dot(normal, camera.placeAt(x, y, 1))));
  return images;
}

template <class Real>
shared::DepthSensorOf<Real> sensor(const DepthCamera& camera) {
  return {.camera = {static_cast<Real>(camera.fx), static_cast<Real>(camera.fy), static_cast<Real>(camera.cx),
                     static_cast<Real>(camera.cy)},
          .noise = {Real(0.0012), Real(0.0019), Real(0.4)}};
}

shared::FusionView viewFrom(const CameraPose& pose) {
  FrameImages images{.camera = smallCamera(), .number = 7, .depths = {}, .colors = {}};
  return fusionView(images, pose, DVec3(0), {});
}

}  // namespace

TEST_CASE_TEMPLATE("a pixel of a plane has its normal and depth, at any slant and in the image's corner", Real, float,
                   double) {
  const DepthCamera camera{.width = 40, .height = 30, .fx = 300, .fy = 310, .cx = 18.2, .cy = 15.1};
  for (const DVec3& towards : {DVec3(0, 0, 1), DVec3(0.8, 0, 0.6), DVec3(-0.3, 0.9, 0.4), DVec3(0.5, 0.5, 1)}) {
    const DVec3 normal = glm::normalize(towards);
    const FrameImages images = planeImage(camera, normal, 0.7 * normal.z);
    for (const auto& [x, y] : {std::pair(20, 15), {0, 0}, {39, 29}, {39, 2}, {1, 17}}) {
      const auto surface = pixelSurface(images, sensor<Real>(camera), x, y);
      const auto depth = static_cast<double>(images.depths[static_cast<std::size_t>(y * 40 + x)]);
      CAPTURE(towards.x);
      REQUIRE(surface.depth > 0);
      // Depths are given in single precision: 1e-7 over 6 pixels of 1 / 300.
      CHECK(glm::distance(DVec3(surface.normal), -normal) < 2e-4);
      CHECK(static_cast<double>(surface.depth) == near(depth, 1e-6));
    }
  }
}

TEST_CASE_TEMPLATE("a surface ends at a depth jump, and a pixel between two surfaces has none", Real, float, double) {
  const DepthCamera camera{.width = 21, .height = 21, .fx = 500, .fy = 500, .cx = 10, .cy = 10};
  FrameImages images = planeImage(camera, DVec3(0, 0, 1), 1.0);
  for (std::size_t pixel = 0; pixel < images.depths.size(); ++pixel)
    if (pixel % 21 > 10) images.depths[pixel] = 1.5f;
  const auto at = [&](int x, int y) { return pixelSurface(images, sensor<Real>(camera), x, y); };
  for (const int x : {9, 10, 11, 12}) {
    CHECK(static_cast<double>(at(x, 10).depth) == near(x > 10 ? 1.5 : 1.0, 1e-6));
    CHECK(static_cast<double>(at(x, 10).normal.z) == near(-1.0, 1e-6));
  }
  images.depths[10 * 21 + 10] = 1.25f;  // between the two surfaces
  CHECK(at(10, 10).depth == 0);
  CHECK(static_cast<double>(at(9, 10).normal.z) == near(-1.0, 1e-6));
  images.depths[10 * 21 + 5] = 1.009f;  // further off its plane than the noise allows
  CHECK(at(5, 10).depth == 0);
  images.depths[10 * 21 + 5] = 1.003f;
  CHECK(at(5, 10).depth > 0);
  images.depths[10 * 21 + 5] = 0;
  CHECK(at(5, 10).depth == 0);
}

TEST_CASE("a plane is fitted over no more pixels than the noise requires, so that a coarse camera keeps curvature") {
  CHECK(shared::fitReach(sensor<double>(smallCamera()), 1.0) == 3);
  const DepthCamera coarse{.width = 24, .height = 18, .fx = 20, .fy = 21, .cx = 11.5, .cy = 8.5};
  CHECK(shared::fitReach(sensor<double>(coarse), 1.5) == 1);
  DepthScene scene;
  scene.add("sphere", 1, {0, 0, 2});
  FrameImages images{.camera = coarse, .number = 0, .depths = scene.frame(coarse, {}).depth_m, .colors = {}};
  std::size_t seen = 0;
  for (int y = 0; y < 18; ++y) {
    for (int x = 0; x < 24; ++x) {
      const auto surface = pixelSurface(images, sensor<double>(coarse), x, y);
      if (!(surface.depth > 0)) continue;
      const auto depth = static_cast<double>(images.depths[static_cast<std::size_t>(y * 24 + x)]);
      CHECK(angleBetween_deg(surface.normal, scene.closest(coarse.placeAt(x, y, depth)).normal) < 15);
      ++seen;
    }
  }
  CHECK(seen > 30);  // of some 140; the others are too slanted for the pixel size and the curvature
}

TEST_CASE("a surface that the camera sees nearly edge-on is rejected") {
  const DepthCamera camera{.width = 15, .height = 15, .fx = 500, .fy = 500, .cx = 7, .cy = 7};
  for (const auto& [angle_deg, is] : {std::pair(70.0, true), {74.0, true}, {83.0, false}}) {
    const double angle = angle_deg * 3.14159265358979 / 180;
    const DVec3 normal(std::sin(angle), 0, std::cos(angle));
    const FrameImages images = planeImage(camera, normal, normal.z);
    const auto surface = pixelSurface(images, sensor<double>(camera), 7, 7);
    CHECK((surface.depth > 0) == is);
  }
}

TEST_CASE("a point is projected into the right pixel and subpixel") {
  const CameraPose pose = onArc(DVec3(0), 1.0, 0.3);
  const shared::FusionView view = viewFrom(pose);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> column(-0.45, 159.45), row(-0.45, 119.45), depth(0.3, 3);
  for (int i = 0; i < 2000; ++i) {
    const double x = column(random), y = row(random), z = depth(random);
    const double u = (x + 0.5) * 4, v = (y + 0.5) * 4;  // in subpixels
    if (std::abs(u - std::round(u)) < 1e-3 || std::abs(v - std::round(v)) < 1e-3) continue;
    const auto projection = shared::projectionOf(view, Vec3(pose.toWorld(smallCamera().placeAt(x, y, z))));
    REQUIRE(projection.inView);
    CHECK(projection.pixel.x == static_cast<uint>(std::lround(x)));
    CHECK(projection.pixel.y == static_cast<uint>(std::lround(y)));
    const auto part = static_cast<uint>(v) % 4 * 4 + static_cast<uint>(u) % 4;
    CHECK(projection.part == (1u << part));
  }
  for (const auto& [x, y, z] : {std::tuple(-0.6, 5.0, 1.0),
                                {159.6, 5.0, 1.0},
                                {5.0, -0.6, 1.0},
                                {5.0, 119.6, 1.0},
                                {5.0, 5.0, -1.0},
                                {79.5, 59.5, 0.0}})
    CHECK_FALSE(shared::projectionOf(view, Vec3(pose.toWorld(smallCamera().placeAt(x, y, z)))).inView);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(shared::projectionOf(view, Vec3(nan, 0, 0)).inView);
}

TEST_CASE("a point covers its own pixel, and the next one within a quarter of a pixel") {
  // In subpixels from the corner of the tested pixel.
  for (int v = -4; v < 8; ++v) {
    for (int u = -4; u < 8; ++u) {
      std::array<std::array<uint, 3>, 3> covered{};  // rows of pixels
      covered[static_cast<std::size_t>(v + 4) / 4][static_cast<std::size_t>(u + 4) / 4] =
          1u << (static_cast<uint>(v + 4) % 4 * 4 + static_cast<uint>(u + 4) % 4);
      const double x = (u + 0.5) / 4 - 0.5, y = (v + 0.5) / 4 - 0.5;  // in pixels from its centre
      const double least = std::min(std::abs(x), std::abs(y)), most = std::max(std::abs(x), std::abs(y));
      CAPTURE(x);
      CAPTURE(y);
      const bool is = shared::isCovered(covered[1][1], covered[1][0], covered[1][2], covered[0][1], covered[2][1]);
      CHECK(is == (least < 0.5 && most < 0.75));
    }
  }
}

TEST_CASE("a point is matched, hidden, seen through or unclear by its depth relative to its pixel") {
  const shared::FusionView view = viewFrom({});
  const shared::PixelSurface wall{.normal = Vec3(0, 0, -1), .depth = 1};
  const Vec3 facing(0, 0, -1), aside(1, 0, 0), away(0, 0, 1);
  const float deviation = 0.0012f + 0.0019f * 0.36f;
  const auto sight = [&](float depth, const Vec3& normal, float measured = 1, float fitted = 1) {
    const auto projection = shared::projectionOf(view, {0, 0, depth});
    return shared::sightOf(view, projection, normal,
                           {.pixel = projection.pixel,
                            .depth = measured,
                            .color = 0,
                            .surface = {.normal = wall.normal, .depth = fitted}});
  };
  for (const float step : {-3.9f, 0.0f, 3.9f}) {
    CHECK(sight(1 + step * deviation, facing).kind == shared::kSightMatched);
    CHECK(sight(1 + step * deviation, facing).covers);
    CHECK(sight(1 + step * deviation, away).kind == shared::kSightUnclear);
    CHECK_FALSE(sight(1 + step * deviation, away).covers);
  }
  CHECK(sight(1 + 4.1f * deviation, facing).kind == shared::kSightHidden);
  CHECK(sight(1 - 4.1f * deviation, facing).kind == shared::kSightUnclear);
  CHECK(sight(1 - 5.1f * deviation, facing).kind == shared::kSightFree);
  CHECK(sight(1 - 5.1f * deviation, away).kind == shared::kSightFree);
  CHECK(sight(0.5f, aside).kind == shared::kSightUnclear);      // edge-on
  CHECK(sight(0.5f, facing, 0, 0).kind == shared::kSightNone);  // nothing was measured
  CHECK(sight(0.5f, facing, 1, 0).kind == shared::kSightFree);  // nothing was fitted
  CHECK(sight(1.0f, facing, 1, 0).kind == shared::kSightUnclear);
  CHECK(shared::seesThrough(view, 0.5f, 0));
  CHECK(shared::seesThrough(view, 0.9f, 1));
  CHECK_FALSE(shared::seesThrough(view, 0.995f, 1));
}

TEST_CASE("weights grow up to the limit of the memory, and a higher weight is not reduced by a worse measurement") {
  CHECK(shared::weightAfter(0, 2, 10) == 2);
  CHECK(shared::weightAfter(2, 2, 10) == 4);
  CHECK(shared::weightAfter(19, 2, 10) == 20);
  CHECK(shared::weightAfter(20, 2, 10) == 20);
  CHECK(shared::weightAfter(500, 2, 10) == 500);  // from a shorter distance
}

TEST_CASE("a stable point is removed after 4 frames of free space, others after 2, or after 30 without a match") {
  const auto framesUntilGone = [](uint measurements, uint sight) {
    shared::SurfelRecord record{.weight = 1, .seen = 0, .counts = measurements, .color = 0};
    for (int frame = 1; frame <= 1000; ++frame) {
      record = shared::doubted(record, sight);
      CHECK(shared::measurementsOf(record) == measurements);
      if (shared::isGivenUp(record)) return frame;
    }
    return 0;
  };
  CHECK(framesUntilGone(4, shared::kSightFree) == 4);
  CHECK(framesUntilGone(0xffff, shared::kSightFree) == 4);
  CHECK(framesUntilGone(3, shared::kSightFree) == 2);
  for (const uint sight : {shared::kSightHidden, shared::kSightUnclear}) {
    CHECK(framesUntilGone(3, sight) == 30);
    CHECK(framesUntilGone(4, sight) == 0);
  }
  CHECK(framesUntilGone(1, shared::kSightNone) == 0);
}

TEST_CASE("a point moves to the weighted mean along its ray and counts its measurements") {
  const shared::FusionView view = viewFrom({});
  shared::Surfel before{.place = Vec3(0, 0, 1.003f),
                        .normal = Vec3(0, 0, -1),
                        .record = {.weight = 0, .seen = 1, .counts = 5 | 30 << 16, .color = 0}};
  const float measurement = shared::measurementWeight(view, 1);
  CHECK(static_cast<double>(measurement) == near(1 / (0.001884 * 0.001884), 1e-5));
  before.record.weight = 2 * measurement;
  // The centre of the central pixel is half a pixel off the axis, so that the ray is not exact.
  const shared::Surfel after = shared::averaged(
      view, before, {.pixel = {79, 59}, .depth = 1, .color = 0, .surface = {.normal = Vec3(0, 0, -1), .depth = 1}});
  CHECK(after.place.x == 0);
  CHECK(after.place.y == 0);
  CHECK(static_cast<double>(after.place.z) == near(1.002, 1e-6));
  CHECK(after.normal == Vec3(0, 0, -1));
  CHECK(shared::measurementsOf(after.record) == 6);
  CHECK(shared::doubtsOf(after.record) == 0);
  CHECK(after.record.seen == 7);
  CHECK(static_cast<double>(after.record.weight) == near(3.0 * static_cast<double>(measurement), 1e-6));
}

TEST_CASE("colours converge to the observed one, and the first is used directly") {
  CHECK(shared::mixedColor(0, 0xff123456u, 0.01f) == 0xff123456u);
  CHECK(shared::mixedColor(0xff0000c8u, 0xff000064u, 0.5f) == 0xff000096u);
  uint color = 0xff00ff00u;
  for (int i = 0; i < 100; ++i) color = shared::mixedColor(color, 0xffff00ffu, 0.001f);
  CHECK((color & 0xffu) > 0xf8u);
  CHECK((color >> 8 & 0xffu) < 8u);
  CHECK((color >> 16 & 0xffu) > 0xf8u);
  CHECK((color >> 24) == 0xffu);
}

TEST_CASE_TEMPLATE("an ICP pair pulls in proportion to its residual, limited for outliers, and not beyond the gate",
                   Real, float, double) {
  using V3 = glm::vec<3, Real>;
  const V3 up(0, 0, 1), pivot(1, 0, 0);
  const auto pair = [&](Real height, const V3& normal, Real gate) {
    return shared::icpPair<Real>({.place = V3(0, 1, height), .normal = normal}, {.place = V3(0, 1, 0), .normal = up},
                                 {.pivot = pivot, .scale = Real(2), .gate = gate}, Real(0.001));
  };
  const auto pull = pair(Real(0.001), up, Real(0.1));
  REQUIRE(pull.isPair);
  CHECK(static_cast<double>(pull.residual) == near(0.001, 1e-5));
  CHECK(static_cast<double>(pull.weight) == near(1e6, 1e-5));
  CHECK(pull.shift == up);
  // A rotation by w about the pivot moves the point by w x (-1, 1, h): along z by w.x + w.y.
  CHECK(static_cast<double>(pull.turn.x) == near(0.5, 1e-6));
  CHECK(static_cast<double>(pull.turn.y) == near(0.5, 1e-6));
  CHECK(static_cast<double>(pull.turn.z) == within(0, 1e-6));
  CHECK(static_cast<double>(pair(Real(0.015), up, Real(0.1)).weight) == near(1e5, 1e-5));
  CHECK_FALSE(pair(Real(0.015), up, Real(0.01)).isPair);
  CHECK_FALSE(pair(Real(0.001), V3(0, 1, 0), Real(0.1)).isPair);
}

}  // namespace palpate::fusion_formulas_test
