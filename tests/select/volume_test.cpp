// Points in boxes, balls and beside planes against their equations, and handles that stay under the mouse.
#include "engine/select/volume.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <glm/gtc/quaternion.hpp>

#include "engine/select/volume_handles.hpp"
#include "tests/near.hpp"
#include "tests/select/some_points.hpp"

namespace palpate::volume_test {

using select_test::pointAt;
using select_test::scattered;

namespace {

constexpr DVec2 kSize_px{900, 600};

DQuat rotated(double angle, const DVec3& axis) {
  return DQuat(std::cos(0.5 * angle), std::sin(0.5 * angle) * glm::normalize(axis));
}

const Volume kVolumes[]{
    {.kind = Volume::Kind::box, .centre = {0.1, -0.2, 0.3}, .half = {0.5, 0.25, 0.75}},
    {.kind = Volume::Kind::box, .centre = {0.1, 0, 0}, .rotation = rotated(0.7, {1, 2, 3}), .half = {0.6, 0.3, 0.2}},
    {.kind = Volume::Kind::box, .centre = {0.2, 0, 0}, .rotation = rotated(2, {0, 1, 1}), .half = {0.6, 0.3, 0}},
    {.kind = Volume::Kind::ball, .centre = {0.25, 0.5, -0.25}, .half = {0.5, 0, 0}},
    {.kind = Volume::Kind::plane, .centre = {0.1, 0.1, 0.1}, .rotation = rotated(1.1, {1, 0, 1}), .half = {1, 1, 1}},
};

// In single steps, along axes that are computed by rotating three unit vectors by a matrix.
bool isInside(const Volume& volume, const DVec3& position) {
  const glm::dmat3 axes(glm::mat3_cast(volume.rotation));
  const DVec3 arm = position - volume.centre;
  if (volume.kind == Volume::Kind::ball) return glm::length(arm) <= volume.half.x;
  if (volume.kind == Volume::Kind::plane) return glm::dot(axes[2], arm) >= 0;
  for (int k = 0; k < 3; ++k)
    if (std::abs(glm::dot(axes[k], arm)) > volume.half[k]) return false;
  return true;
}

DVec2 seen(const DVec3& position, const Camera& camera) {
  const auto place = camera.project(position, kSize_px);
  REQUIRE(place);
  return DVec2(*place);
}

const Camera kCameras[]{{.eye = {3, 1, 2}, .target = {0, 0, 0}, .up = {0, 0, 1}},
                        {.eye = {-1, 4, 0.5}, .target = {0.3, 0, 0.1}, .up = {0, 0, 1}, .fov_deg = 60},
                        {.eye = {0.5, -0.4, -5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fov_deg = 20}};

void forEachHandle(const std::function<void(const HandledVolume&, const VolumeHandle&, const Camera&)>& use) {
  for (const Camera& camera : kCameras)
    for (const Volume& volume : kVolumes)
      for (const bool moves : {false, true}) {
        if (moves && volume.kind != Volume::Kind::box) continue;
        const HandledVolume handled{volume, moves};
        for (const VolumeHandle& handle : handled.handles()) use(handled, handle, camera);
      }
}

}  // namespace

TEST_CASE("the points in a volume are those for which its equations hold, at any number of points") {
  for (const std::size_t count : {0U, 1U, 63U, 64U, 65U, 3000U}) {
    const std::vector<PointState> points = scattered(count, 5);
    const PointBits among = PointBits::where(count, 1, [&](std::size_t i) { return !points[i].gone && i % 3 != 1; });
    for (const Volume& volume : kVolumes) {
      const PointBits found = pointsIn(points, among, volume, 2);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < count; ++i)
        wrong += found.test(i) != (among.test(i) && isInside(volume, DVec3(points[i].position)));
      CHECK(wrong == 0);
      if (count == 3000 && volume.half.z != 0) CHECK(found.count() > 20);
    }
  }
}

TEST_CASE("the border of a volume counts, also one without any size") {
  const std::vector<PointState> points{pointAt({1, 2, 3}, 0), pointAt({1, 2, 3.5}, 1), pointAt({0, 2, 3}, 2)};
  PointBits all(3);
  for (std::size_t i = 0; i < 3; ++i) all.set(i);
  const auto in = [&](const Volume& volume) { return pointsIn(points, all, volume).count(); };
  CHECK(in({.centre = {1, 2, 3}, .half = {0, 0, 0.5}}) == 2);
  CHECK(in({.centre = {1, 2, 3}, .half = DVec3(0)}) == 1);
  CHECK(in({.kind = Volume::Kind::ball, .centre = {1, 2, 3}, .half = DVec3(1)}) == 3);
  CHECK(in({.kind = Volume::Kind::ball, .centre = {1, 2, 3}, .half = DVec3(0)}) == 1);
  CHECK(in({.kind = Volume::Kind::plane, .centre = {9, 9, 3}}) == 3);
  CHECK(in({.kind = Volume::Kind::plane, .centre = {9, 9, 3.25}}) == 1);
  const Volume box = boxAround(points, all);
  CHECK(box.centre == DVec3(0.5, 2, 3.25));
  CHECK(box.half == DVec3(0.5, 0, 0.25));
  CHECK(in(box) == 3);
  CHECK(boxAround(points, PointBits(3)).half == DVec3(0));
}

TEST_CASE("each handle is found at its position, and a press beside all of them finds none") {
  forEachHandle([](const HandledVolume& handled, const VolumeHandle& handle, const Camera& camera) {
    const DVec2 at = seen(handled.placeOf(handle, camera), camera);
    const auto found = handled.handleAt(at, camera, kSize_px);
    REQUIRE(found);
    // Another one may be at the same pixel, in front of it or behind.
    CHECK(glm::distance(seen(handled.placeOf(*found, camera), camera), at) < 1);
    CHECK_FALSE(handled.handleAt({-500, -500}, camera, kSize_px));
  });
}

TEST_CASE("a handle that is dragged is where the mouse is, and changes nothing but what it is for") {
  std::size_t followed = 0;
  forEachHandle([&](const HandledVolume& handled, const VolumeHandle& handle, const Camera& camera) {
    CAPTURE(static_cast<int>(handle.kind));
    CAPTURE(handle.axis);
    using Kind = VolumeHandle::Kind;
    const Volume& before = handled.volume;
    const DVec2 from = seen(handled.placeOf(handle, camera), camera);
    CHECK(handled.dragged(handle, camera, kSize_px, from, from).centre == before.centre);
    // Where the handle would be after a known change.
    HandledVolume wanted = handled;
    const DVec3 axis = before.axis(handle.axis);
    if (handle.kind == Kind::centre)
      wanted.volume.centre += 0.3 * camera.axes().right - 0.2 * glm::normalize(camera.axes().up);
    if (handle.kind == Kind::arrow) wanted.volume.centre += 0.2 * axis;
    if (handle.kind == Kind::side) {
      wanted.volume.half[handle.axis] += 0.1;
      wanted.volume.centre += 0.1 * handle.sign * axis;
    }
    if (handle.kind == Kind::ring) wanted.volume.rotation = rotated(0.3, axis) * before.rotation;
    if (handle.kind == Kind::size) wanted.volume.half *= 1.5;
    const DVec2 to = seen(wanted.placeOf(handle, camera), camera);
    const HandledVolume after{handled.dragged(handle, camera, kSize_px, from, to), handled.movesPoints};
    CHECK(glm::length(after.volume.rotation) == within(1, 1e-12));
    // A handle whose motion is along the line of sight cannot follow, nor one of a ring that is seen from its edge.
    const DVec3 sight = glm::normalize(before.centre - camera.eye);
    const double facing = std::abs(glm::dot(sight, axis));
    const bool follows = handle.kind == Kind::ring   ? facing > 0.35
                         : handle.kind == Kind::size ? before.kind == Volume::Kind::ball
                                                     : facing < 0.95;
    if (follows) {
      CHECK(glm::distance(seen(after.placeOf(handle, camera), camera), to) < 3);
      ++followed;
    }
    const bool keepsCentre = handle.kind == Kind::ring || handle.kind == Kind::size;
    if (keepsCentre) CHECK(after.volume.centre == before.centre);
    if (handle.kind != Kind::ring) CHECK(after.volume.rotation == before.rotation);
    if (handle.kind == Kind::centre || handle.kind == Kind::arrow || handle.kind == Kind::ring)
      CHECK(after.volume.half == before.half);
    if (handle.kind == Kind::ring && follows)
      CHECK(std::abs(glm::dot(after.volume.rotation, wanted.volume.rotation)) > 0.999);
    if (handle.kind == Kind::side) {
      const auto opposite = [&](const Volume& v) { return v.centre - handle.sign * v.half[handle.axis] * axis; };
      CHECK(glm::distance(opposite(after.volume), opposite(before)) < 1e-9);
    }
  });
  CHECK(followed > 60);
}

TEST_CASE("a side that is dragged past the opposite one stops there") {
  const HandledVolume handled{kVolumes[0]};
  const Camera& camera = kCameras[0];
  const VolumeHandle side{VolumeHandle::Kind::side, 1, 1};
  const DVec2 from = seen(handled.placeOf(side, camera), camera);
  const DVec2 to = seen(handled.volume.centre - 3.0 * handled.volume.axis(1), camera);
  const Volume flat = handled.dragged(side, camera, kSize_px, from, to);
  CHECK(flat.half[1] == 0);
  CHECK(flat.centre.y == within(handled.volume.centre.y - handled.volume.half.y, 1e-9));
}

TEST_CASE("the outline of a volume lies on it") {
  for (const Camera& camera : kCameras)
    for (const Volume& volume : kVolumes) {
      std::size_t ends = 0, off = 0;
      for (const auto& edge : HandledVolume{volume}.edges(camera))
        for (const DVec3& end : edge) {
          const DVec3 arm = end - volume.centre;
          const DVec3 own = glm::abs(
              DVec3(glm::dot(arm, volume.axis(0)), glm::dot(arm, volume.axis(1)), glm::dot(arm, volume.axis(2))));
          ++ends;
          if (volume.kind == Volume::Kind::ball) off += std::abs(glm::length(arm) - volume.half.x) > 1e-9;
          if (volume.kind == Volume::Kind::box) off += glm::any(glm::greaterThan(own, volume.half + 1e-9));
        }
      CHECK(ends > 0);
      CHECK(off == 0);
    }
}

}  // namespace palpate::volume_test
