#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "haptics/shared_presence.hpp"

namespace palpate::shared_presence_test {

namespace {

CameraPlace squareCamera() { return {.position = DVec3(1, 2, 3), .fovY_rad = std::numbers::pi / 2, .aspect = 1.5}; }

}  // namespace

TEST_CASE("a camera's frustum has its angle, its aspect and its orientation") {
  const CameraFrustum straight = frustumOf(squareCamera());
  CHECK(straight.centre == DVec3(1, 2, 3));
  const DVec3 corners[4] = {{-1.5, -1, 1}, {1.5, -1, 1}, {1.5, 1, 1}, {-1.5, 1, 1}};
  for (std::size_t k = 0; k < 4; ++k) CHECK(glm::distance(straight.corners[k], corners[k]) < 1e-12);
  // Rotated by a quarter about y: the former right side is behind, and it looks along x.
  CameraPlace turned = squareCamera();
  turned.turn = DQuat(std::sqrt(0.5), 0, std::sqrt(0.5), 0);
  CHECK(glm::distance(frustumOf(turned).corners[1], DVec3(1, -1, -1.5)) < 1e-12);
}

TEST_CASE("invalid positions, angles and aspects make no camera") {
  CHECK(isCamera(squareCamera()));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInf, -kInf}) {
    CameraPlace camera = squareCamera();
    camera.position.y = bad;
    CHECK_FALSE(isCamera(camera));
    camera = squareCamera();
    camera.turn.x = bad;
    CHECK_FALSE(isCamera(camera));
  }
  for (const double bad : {kNan, kInf, 0.0, -1.0, std::numbers::pi}) {
    CameraPlace camera = squareCamera();
    camera.fovY_rad = bad;
    CHECK_FALSE(isCamera(camera));
  }
  for (const double bad : {kNan, kInf, 0.0, -1.0, 1e4}) {
    CameraPlace camera = squareCamera();
    camera.aspect = bad;
    CHECK_FALSE(isCamera(camera));
  }
  CameraPlace camera = squareCamera();
  camera.turn = DQuat(0.5, 0, 0, 0);
  CHECK_FALSE(isCamera(camera));
}

}  // namespace palpate::shared_presence_test
