// View frusta of cameras, compared with the projection formula: a corner of the pyramid is projected to the corner of
// the picture.
#include "engine/io/colmap_frusta.hpp"

#include <doctest/doctest.h>

#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "tests/colmap_writer.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test::colmap_frusta_test {
namespace {

const DQuat kTurn = glm::normalize(DQuat(0.8, 0.3, -0.4, 0.2));
const DVec3 kCentre{3, -7, 11};
const std::array<DVec2, 4> kCorners{{{0, 0}, {640, 0}, {640, 480}, {0, 480}}};

std::vector<CameraFrustum> frustaWith(const std::string& camera) {
  const ScratchFolder folder;
  writeColmap(folder.path(), {.camera = camera, .images = {{.centre = kCentre, .turn = kTurn}}, .points = {}});
  return frustaOf(readColmapImages(folder.path()));
}

/// In camera coordinates: x right, y down, z forward.
DVec3 seen(const DVec3& place) { return glm::mat3_cast(kTurn) * (place - kCentre); }

}  // namespace

TEST_CASE("the corners of a frustum project to the corners of the picture") {
  // Distortion is left out, so that models of the same focal lengths see the same.
  for (const auto& [camera, fx, fy, cx, cy] :
       {std::tuple{"4 PINHOLE 640 480 500 510 310 250", 500., 510., 310., 250.},
        {"4 SIMPLE_PINHOLE 640 480 500 310 250", 500., 500., 310., 250.},
        {"4 SIMPLE_RADIAL 640 480 500 310 250 -0.1", 500., 500., 310., 250.},
        {"4 RADIAL 640 480 700 310 250 -0.1 0.02", 700., 700., 310., 250.},
        {"4 OPENCV 640 480 500 510 310 250 0.1 0.1 0.01 0.01", 500., 510., 310., 250.}}) {
    CAPTURE(camera);
    const auto frusta = frustaWith(camera);
    REQUIRE(frusta.size() == 1);
    CHECK(glm::distance(frusta[0].centre, kCentre) < 1e-12);
    for (std::size_t k = 0; k < 4; ++k) {
      const DVec3 p = seen(frusta[0].centre + 2.5 * frusta[0].corners[k]);
      CHECK(p.z == near(2.5, 1e-6));
      CHECK(fx * p.x / p.z + cx == within(kCorners[k].x, 1e-6));
      CHECK(fy * p.y / p.z + cy == within(kCorners[k].y, 1e-6));
    }
  }
}

TEST_CASE("the frustum of a fisheye lens follows its angles, up to the widest angle of a pyramid") {
  const auto frusta = frustaWith("4 OPENCV_FISHEYE 640 480 500 500 320 240 0 0 0 0");
  REQUIRE(frusta.size() == 1);
  const DVec3 p = seen(frusta[0].centre + frusta[0].corners[0]);
  CHECK(std::atan2(std::hypot(p.x, p.y), p.z) == near(std::hypot(320, 240) / 500, 1e-6));
  CHECK(p.x / p.y == near(320.0 / 240, 1e-6));
  const auto wide = frustaWith("4 SIMPLE_RADIAL_FISHEYE 640 480 200 320 240 0");
  const DVec3 far = seen(wide.at(0).centre + wide.at(0).corners[2]);
  CHECK(std::atan2(std::hypot(far.x, far.y), far.z) * 180 / std::numbers::pi == near(74.5, 0.01));
}

TEST_CASE("a camera with an invalid focal length or size has no frustum") {
  CHECK(frustaWith("4 PINHOLE 640 480 0 510 310 250").empty());
  CHECK(frustaWith("4 PINHOLE 640 480 500 -510 310 250").empty());
  CHECK(frustaWith("4 PINHOLE 640 480 500 1e-300 310 250").empty());
  CHECK(frustaWith("4 PINHOLE 0 480 500 510 310 250").empty());
}

TEST_CASE("the corners of a depth camera's frustum are half a pixel outside the centres of its corner pixels") {
  const DepthCamera camera{.width = 640, .height = 480, .fx = 525, .fy = 530, .cx = 319, .cy = 241};
  const CameraPose pose{.turn = glm::conjugate(kTurn), .centre = kCentre};
  const CameraFrustum frustum = frustumOf(camera, pose);
  for (std::size_t k = 0; k < 4; ++k) {
    const DVec3 p = seen(frustum.centre + 0.3 * frustum.corners[k]);
    CHECK(p.z == near(0.3, 1e-6));
    CHECK(525 * p.x / p.z + 319 == within(kCorners[k].x - 0.5, 1e-6));
    CHECK(530 * p.y / p.z + 241 == within(kCorners[k].y - 0.5, 1e-6));
  }
}

}  // namespace palpate::test::colmap_frusta_test
