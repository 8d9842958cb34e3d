// Pictures of an orthographic camera: those of a pinhole camera far away with a narrow field of view.
#include <cmath>
#include <glm/trigonometric.hpp>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/error.hpp"
#include "engine/render/camera_motion.hpp"
#include "tests/near.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::orthographic_test {

namespace {

constexpr std::uint32_t kSide = 160;
constexpr double kHeight = 2.6, kNarrow_deg = 0.25;

Camera orthographic() {
  Camera camera{.eye = DVec3(2, 1.4, 3), .up = {0, 1, 0}, .height = kHeight};
  camera.setDepthRange({DVec3(-1), DVec3(1)}, 2);
  return camera;
}
Camera farAway() {
  const double distance = 0.5 * kHeight / std::tan(glm::radians(kNarrow_deg) / 2);
  return {.eye = distance * glm::normalize(DVec3(2, 1.4, 3)),
          .up = {0, 1, 0},
          .fov_deg = kNarrow_deg,
          .nearDepth = distance / 2};
}

/// A sphere above a plate, with grooves between them.
PointCloud scene() {
  PointCloud cloud = sampleShape(*makeShape("sphere", 1.4), {.count = 20'000});
  for (double x = -0.9; x < 0.9; x += 0.015)
    for (double z = -0.9; z < 0.9; z += 0.015) {
      cloud.positions.emplace_back(x, -0.75, z);
      cloud.normals.emplace_back(0, 1, 0);
    }
  return cloud;
}

struct Difference {
  double mean = 0, strong = 0;  ///< of the channels, 0 to 255; share of the pixels that differ by more than 24
};
Difference between(const Image& a, const Image& b) {
  Difference difference;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    int largest = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int apart = std::abs(int{a.rgba[i][k]} - int{b.rgba[i][k]});
      largest = std::max(largest, apart);
      difference.mean += apart;
    }
    difference.strong += largest > 24;
  }
  const auto pixels = static_cast<double>(a.rgba.size());
  return {difference.mean / (4 * pixels), difference.strong / pixels};
}

}  // namespace

TEST_CASE_FIXTURE(PictureFixture, "an orthographic picture is that of a camera far away, with all light and overlays") {
  const PointCloud cloud = scene();
  const DrawnCloud drawn(device, cloud);
  FrameOptions options;
  options.splatRadius = 1.95 * meanSpacing(cloud);
  SUBCASE("plain") {}
  SUBCASE("smoothed") { options.smooth_px = 4; }
  SUBCASE("without smoothing over samples") { options.everyPoint = true; }
  SUBCASE("normals") { options.pass = ImagePass::normal; }
  SUBCASE("positions") { options.pass = ImagePass::position; }
  SUBCASE("occlusion and cavities") { options.light = {.occlusion = true, .cavity = true}; }
  SUBCASE("ground") {
    options.light.ground = true;
    options.background = {255, 255, 255};
  }
  SUBCASE("metal") { options.light.material = Material::metal; }
  SUBCASE("eye-dome light") { options.light = {.material = Material::unlit, .eyeDome = true}; }
  SUBCASE("transparent") { options.transparent = true; }
  SUBCASE("overlays") {
    options.overlays.hip = Overlays::Ball{.center = {0.2, 0.9, 0.4}, .radius = 0.2};
    options.overlays.proxy = Overlays::Disc{.center = {0.6, 0.5, 0.6}, .radius = 0.2};
    options.overlays.force = Overlays::Arrow{.from = {-0.8, 0, 0.5}, .along = {0, 0.8, 0.2}, .shaftRadius = 0.03};
    options.overlays.brush = Overlays::Ball{.center = {0, 0, 0.7}, .radius = 0.4};
    options.overlays.scale = Overlays::Bar{.from = {-0.5, -0.9, 1}, .along = {1, 0, 0}, .radius = 0.02};
  }
  SUBCASE("lines before, in and behind the surface") {
    options.lines = std::make_shared<const std::vector<SpaceLine>>(
        std::vector<SpaceLine>{{.from = {-3, 0.1, 0}, .to = {3, 0.2, 0.2}, .color = {255, 0, 0}, .width_px = 3},
                               {.from = {0, -3, 1}, .to = {0.1, 4, 1}, .color = {0, 255, 0}, .width_px = 3},
                               {.from = {-1, 0.5, -9}, .to = {1, 0.5, 5}, .color = {0, 90, 255}, .width_px = 3}});
  }
  Frame& frame = frameOf(kSide, kSide, 2);
  draw(frame, drawn, farAway(), options);
  const Image expected = frame.readColor();
  draw(frame, drawn, orthographic(), options);
  const Difference difference = between(frame.readColor(), expected);
  CAPTURE(difference.mean);
  CHECK(difference.mean < 0.6);
  CHECK(difference.strong < 0.01);
  // The test sees a difference of perspective.
  draw(frame, drawn, projecting(orthographic(), false), options);
  CHECK(between(frame.readColor(), expected).strong > 0.03);
}

TEST_CASE_FIXTURE(PictureFixture, "depths of an orthographic picture give the surface by unproject()") {
  const PointCloud cloud = sampleShape(*makeShape("sphere", 2.0), {.count = 20'000});
  FrameOptions options;
  options.splatRadius = 1.95 * meanSpacing(cloud);
  const Camera camera = orthographic();
  Frame& frame = frameOf(kSide, kSide, 1);
  draw(frame, DrawnCloud(device, cloud), camera, options);
  const DepthImage depths = frame.readDepth();
  const double pixel = camera.pixelSize(1, kSide);
  std::size_t inside = 0, wrong = 0;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const double away = pixel * glm::length(DVec2(x + 0.5, y + 0.5) - 0.5 * kSide);
      if (away > 1 + 2 * pixel) CHECK(depths.at(x, y) == 0);
      if (away > 0.95) continue;
      ++inside;
      const DVec3 place = camera.unproject({x + 0.5, y + 0.5}, double{depths.at(x, y)}, DVec2(kSide));
      wrong += !(glm::length(place) == within(1, 0.01)) || glm::dot(place, camera.towardsViewer(place)) < 0;
    }
  CHECK(inside > 8000);
  CHECK(wrong == 0);
}

TEST_CASE_FIXTURE(PictureFixture, "the hardware rasteriser rejects an orthographic camera in words") {
  const PointCloud cloud = sampleShape(*makeShape("sphere", 2.0), {.count = 500});
  FrameOptions options;
  options.splatRadius = 0.1;
  options.raster = Raster::hardware;
  const DrawnCloud drawn(device, cloud);
  CHECK_THROWS_AS(draw(frameOf(kSide, kSide, 1), drawn, orthographic(), options), UsageError);
}

TEST_CASE_FIXTURE(PictureFixture, "a transparent picture laid over a colour is the picture before that colour") {
  const PointCloud cloud = sampleShape(*makeShape("sphere", 1.6), {.count = 20'000});
  const DrawnCloud drawn(device, cloud);
  FrameOptions options;
  options.splatRadius = 1.95 * meanSpacing(cloud);
  options.overlays.hip = Overlays::Ball{.center = {-0.7, 0.7, 0}, .radius = 0.25};
  options.lines = std::make_shared<const std::vector<SpaceLine>>(
      std::vector<SpaceLine>{{.from = {-2, 0.9, 0}, .to = {2, 0.9, 0}, .color = {255, 0, 0}, .opacity = 0.5}});
  for (const std::uint32_t supersample : {1u, 2u}) {
    CAPTURE(supersample);
    Frame& frame = frameOf(kSide, kSide, supersample);
    options.transparent = true;
    options.background.reset();
    draw(frame, drawn, orthographic(), options);
    const Image clear = frame.readColor();
    options.transparent = false;
    options.background = {0, 0, 255};
    draw(frame, drawn, orthographic(), options);
    const Image before = frame.readColor();
    std::size_t empty = 0, full = 0, edges = 0, wrong = 0;
    for (std::size_t i = 0; i < clear.rgba.size(); ++i) {
      const auto& pixel = clear.rgba[i];
      (pixel[3] == 0 ? empty : pixel[3] == 255 ? full : edges) += 1;
      CHECK(before.rgba[i][3] == 255);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto light = [](std::uint8_t encoded) {
          const double x = encoded / 255.0;
          return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
        };
        const double opacity = pixel[3] / 255.0;
        const double laid = opacity * light(pixel[k]) + (1 - opacity) * (k == 2 ? 1 : 0);
        wrong += std::abs(laid - light(before.rgba[i][k])) > 0.02;
      }
    }
    CHECK(empty > 5000);
    CHECK(full > 5000);
    CHECK(edges > 100);
    CHECK(wrong == 0);
  }
}

}  // namespace palpate::orthographic_test
