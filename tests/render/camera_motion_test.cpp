#include "engine/render/camera_motion.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/near.hpp"

namespace palpate::camera_motion_test {

namespace {

const DVec2 kSize_px(640, 480);

Camera someCamera() { return {.eye = {3, 2, 10}, .target = {1, -1, 0.5}, .nearDepth = 1e-3}; }

double offBy(const Camera& camera, const DVec3& point, const DVec2& place_px) {
  const auto seen = camera.project(point, kSize_px);
  REQUIRE(seen);
  return glm::distance(DVec2(*seen), place_px);
}

}  // namespace

TEST_CASE("the pivot of an orbit keeps its position on screen and its distance") {
  Camera camera = someCamera();
  const DVec3 pivot(1.5, 0.3, 2);
  const DVec2 before(*camera.project(pivot, kSize_px));
  const double distance = glm::distance(camera.eye, pivot);
  for (const DVec2 way : {DVec2(30, 0), DVec2(0, 20), DVec2(-70, -11), DVec2(1, 300), DVec2(500, -2000)}) {
    camera = orbited(camera, pivot, way, kSize_px);
    CHECK(offBy(camera, pivot, before) < 1e-6);
    CHECK(glm::distance(camera.eye, pivot) == near(distance, 1e-6));
    CHECK(isFinite(camera.axes().right));
  }
}

TEST_CASE("an orbit never tips over, for any mouse movement") {
  Camera camera = someCamera();
  for (int i = 0; i < 50; ++i) camera = orbited(camera, camera.target, {3, 100}, kSize_px);
  CHECK(camera.axes().up.y > 0);
  CHECK(camera.axes().forward.y < -0.99);  // the hand moves down, the eye up
  for (int i = 0; i < 50; ++i) camera = orbited(camera, camera.target, {0, -100}, kSize_px);
  CHECK(camera.axes().up.y > 0);
  CHECK(camera.axes().forward.y > 0.99);
}

TEST_CASE("the grabbed point follows the mouse when the view is panned") {
  const Camera camera = someCamera();
  const DVec3 grasped(2, 1, -1);
  const auto seen = *camera.project(grasped, kSize_px);
  const DVec2 way(37, -12);
  CHECK(offBy(panned(camera, seen.z, way, kSize_px), grasped, DVec2(seen) + way) < 1e-6);
}

TEST_CASE("zooming goes to the point under the mouse, which stays on screen, within the limits") {
  Camera camera = someCamera();
  const DVec3 point(2, 1, -1);
  const DVec2 before(*camera.project(point, kSize_px));
  camera = zoomed(camera, point, 0.5, 0.1, 100);
  CHECK(offBy(camera, point, before) < 1e-6);
  CHECK(glm::distance(camera.eye, point) == near(0.5 * glm::distance(someCamera().eye, point), 1e-6));
  for (int i = 0; i < 100; ++i) camera = zoomed(camera, point, 0.5, 0.1, 100);
  CHECK(glm::distance(camera.eye, point) == near(0.1, 1e-6));
  for (int i = 0; i < 100; ++i) camera = zoomed(camera, point, 3, 0.1, 100);
  CHECK(glm::distance(camera.eye, point) == near(100, 1e-6));
  camera.eye = point;
  CHECK(zoomed(camera, point, 0.5, 0.1, 100).eye == point);  // no distance left to move
}

TEST_CASE("a new centre keeps direction and size, a view axis keeps the distance") {
  const Camera camera = someCamera();
  const DVec3 center = camera.target + DVec3(0.5, 0.6, -0.7);
  const auto depthOf = [&](const Camera& of) { return glm::dot(center - of.eye, of.axes().forward); };
  const Camera moved = recentred(camera, center);
  CHECK(moved.target == center);
  CHECK(depthOf(moved) == near(depthOf(camera), 1e-9));
  CHECK(glm::distance(recentred(moved, center).eye, moved.eye) < 1e-9);
  const DVec3 behind = camera.eye - camera.axes().forward;
  CHECK(glm::distance(recentred(camera, behind).eye, behind) == near(glm::distance(camera.eye, camera.target), 1e-9));
  CHECK(glm::distance(moved.axes().forward, camera.axes().forward) < 1e-12);
  const double distance = glm::distance(camera.eye, camera.target);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool above : {true, false}) {
      const Camera along = alongAxis(camera, axis, above, UpAxis::y, frontOf(UpAxis::y));
      CHECK(along.target == camera.target);
      CHECK(glm::distance(along.eye, along.target) == near(distance, 1e-6));
      CHECK(along.axes().forward[axis] * (above ? -1 : 1) > 1 - 1e-11);
      CHECK(isFinite(along.axes().right));
      for (const auto& [name, up] : kUpAxes) {
        CAPTURE(name);
        const Camera turned = alongAxis(camera, axis, above, up, frontOf(up));
        CHECK(turned.axes().forward[axis] * (above ? -1 : 1) > 1 - 1e-11);
        CHECK(turned.up == directionOf(up));
        // From the side up is up; from above the front is at the bottom.
        const bool alongUp = directionOf(up)[axis] != 0;
        const double downwards = -turned.axes().forward[axis] * directionOf(up)[axis];
        const DVec3 expected = alongUp ? -downwards * frontOf(up) : directionOf(up);
        CHECK(glm::dot(turned.axes().up, expected) > 0.95);
      }
    }
}

TEST_CASE("front and top views are right for any up axis") {
  const Camera camera = someCamera();
  const double distance = glm::distance(camera.eye, camera.target);
  const auto from = [&](ModelSide side, UpAxis up) { return fromSide(camera, side, up, frontOf(up)); };
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    const DVec3 top = directionOf(up), front = frontOf(up);
    for (const auto& [side, each] : kModelSides) {
      CAPTURE(side);
      CHECK(from(each, up).target == camera.target);
      CHECK(glm::distance(from(each, up).eye, camera.target) == near(distance, 1e-9));
      CHECK(isFinite(from(each, up).axes().right));
    }
    CHECK(glm::dot(from(ModelSide::front, up).axes().forward, -front) > 0.999);
    CHECK(glm::dot(from(ModelSide::back, up).axes().forward, front) > 0.999);
    CHECK(glm::dot(from(ModelSide::top, up).axes().forward, -top) > 0.98);
    CHECK(glm::dot(from(ModelSide::bottom, up).axes().forward, top) > 0.98);
    // Seen from the front, the right side is on the right.
    const DVec3 right = from(ModelSide::front, up).axes().right;
    CHECK(glm::dot(from(ModelSide::right, up).axes().forward, -right) > 0.999);
    CHECK(glm::dot(from(ModelSide::left, up).axes().forward, right) > 0.999);
    const DVec3 iso = -from(ModelSide::isometric, up).axes().forward;
    for (const DVec3& side : {front, right, top}) CHECK(glm::dot(iso, side) == near(1 / std::sqrt(3.0), 1e-6));
  }
  CHECK(glm::dot(from(ModelSide::front, UpAxis::z).axes().forward, DVec3(0, 1, 0)) > 0.999);
  CHECK(glm::dot(from(ModelSide::right, UpAxis::z).axes().forward, DVec3(-1, 0, 0)) > 0.999);
}

TEST_CASE("an orthographic view is moved like one in perspective, and both show as much at the target") {
  const Camera perspective = someCamera();
  const Camera camera = projecting(perspective, true);
  REQUIRE(camera.isOrthographic());
  CHECK(camera.pixelSize(1, kSize_px.y) ==
        near(perspective.pixelSize(glm::distance(perspective.eye, perspective.target), kSize_px.y), 1e-12));
  CHECK(glm::distance(projecting(camera, false).eye, perspective.eye) < 1e-9);
  CHECK(projecting(camera, true) == camera);
  const DVec3 point(2, 1, -1);
  const DVec2 before(*camera.project(point, kSize_px)), way(37, -12);
  CHECK(offBy(orbited(camera, point, way, kSize_px), point, before) < 1e-6);
  CHECK(offBy(panned(camera, 5, way, kSize_px), point, before + way) < 1e-6);
  const Camera nearer = zoomed(camera, point, 0.5, 0.1, 100);
  CHECK(offBy(nearer, point, before) < 1e-6);
  CHECK(nearer.height == near(0.5 * camera.height, 1e-12));
  CHECK(zoomed(camera, point, 1e-9, 0.1, 100).height == near(0.1, 1e-12));
}

TEST_CASE("a way passes through its cameras, and goes around what opposite ones look at") {
  const Camera front{.eye = {1, 2, 13}, .target = {1, 2, 3}}, back{.eye = {1, 2, -7}, .target = {1, 2, 3}},
      above{.eye = {1, 42, 3}, .target = {1, 2, 3}, .up = {0, 0, -1}, .fov_deg = 30};
  const std::array<Camera, 3> cameras{front, back, above};
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const Camera at = alongCameras(cameras, static_cast<double>(k));
    CHECK(glm::distance(at.eye, cameras[k].eye) < 1e-9);
    CHECK(glm::distance(at.target, cameras[k].target) < 1e-12);
    CHECK(glm::distance(at.axes().up, cameras[k].axes().up) < 1e-9);
    CHECK(at.fov_deg == near(cameras[k].fov_deg, 1e-12));
  }
  double longest = 0;
  DVec3 before = front.eye;
  for (double at = 0; at <= 2; at += 0.01) {
    const Camera camera = alongCameras(cameras, at);
    const double distance = glm::distance(camera.eye, camera.target);
    CHECK(distance > 8);
    CHECK(distance < 42);
    CHECK(glm::length(camera.up) == near(1, 1e-9));
    longest = std::max(longest, glm::distance(camera.eye, before));
    before = camera.eye;
  }
  CHECK(longest < 1.5);  // a hundredth of a leg: it does not jump
  CHECK(alongCameras(cameras, -1).eye == alongCameras(cameras, 0).eye);
  CHECK(alongCameras(cameras, 7).eye == alongCameras(cameras, 2).eye);
  CHECK(glm::distance(alongCameras(std::span(&front, 1), 0.5).eye, front.eye) < 1e-9);
  // Who turns the head stays where they are.
  Camera aside = front;
  aside.target = front.eye + DVec3(10, 0, 0);
  for (double at = 0; at <= 1; at += 0.1)
    CHECK(glm::distance(alongCameras(std::array{front, aside}, at).eye, front.eye) < 1e-9);
  Camera flat = front, flatter = front;
  flat.height = 1, flatter.height = 4;
  CHECK(alongCameras(std::array{flat, flatter}, 0.5).height == near(2, 1e-9));
}

}  // namespace palpate::camera_motion_test
