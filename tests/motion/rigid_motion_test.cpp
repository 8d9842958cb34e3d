#include "engine/motion/rigid_motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/motion/moving_cloud.hpp"
#include "tests/moving_shape.hpp"
#include "tests/scenes.hpp"

namespace palpate::rigid_motion_test {

namespace {

const std::vector<RigidMotion>& motions() {
  static const std::vector<RigidMotion> motions{
      {.axis = {0.6, 0, 0.8}, .amplitude = 5, .frequency_Hz = 0.5},
      {.kind = MotionKind::drift, .axis = {0, 1, 0}, .speed = 30},
      {.kind = MotionKind::turn, .axis = {0, 0.6, 0.8}, .centre = {1, 2, 3}, .frequency_Hz = 0.7}};
  return motions;
}

}  // namespace

TEST_CASE("velocities are the derivative of positions") {
  const DVec3 rest(10, -20, 30);
  for (const RigidMotion& motion : motions())
    for (const double time_s : {0.0, 0.3, 17.0}) {
      constexpr double kStep_s = 1e-5;
      const RigidPose pose = motion.poseAt(time_s);
      const DVec3 change =
          (motion.poseAt(time_s + kStep_s).moved(rest) - motion.poseAt(time_s - kStep_s).moved(rest)) / (2 * kStep_s);
      CHECK(glm::distance(change, pose.velocityAt(pose.moved(rest))) < 1e-5 * glm::length(change) + 1e-7);
    }
}

TEST_CASE("a moved position maps back to its rest position, and at time 0 nothing has moved") {
  const DVec3 rest(10, -20, 30);
  for (const RigidMotion& motion : motions()) {
    CHECK(motion.poseAt(0).moved(rest) == rest);
    const RigidPose pose = motion.poseAt(2.3);
    CHECK(glm::distance(pose.movedBack(pose.moved(rest)), rest) < 1e-12);
    CHECK(glm::distance(pose.moved(rest), rest) > 1);
    CHECK(glm::distance(pose.turnedBack(pose.turned(rest)), rest) < 1e-12);
  }
  const RigidMotion& oscillation = motions()[0];
  CHECK(glm::distance(oscillation.poseAt(0.5).moved(rest), rest + 5.0 * oscillation.axis) < 1e-12);
  CHECK(glm::distance(motions()[2].poseAt(1 / 0.7).moved(rest), rest) < 1e-12);
}

TEST_CASE("points of a moving shape lie on it, with its normals and exact velocities, also far from the origin") {
  for (const DVec3 center : {DVec3(0), DVec3(-1e6, 2e6, 5e5)})
    for (const RigidMotion& motion : motions()) {
      const Scene scene = makeScene("torus", 3'000, center);
      MovingCloud source(scene.cloud, motion);
      const MovingShape truth(*scene.shape, motion, scene.cloud.origin);
      CloudFrame frame;
      for (const double time_s : {0.0, 0.4, 3.1}) {
        source.makeFrame(time_s, frame);
        requireWhole(frame, source.size());
        CHECK(frame.time_s == time_s);
        double farthest = 0, crooked = 0, slow = 0;
        const RigidPose pose = motion.poseAt(time_s);
        for (std::size_t i = 0; i < source.size(); ++i) {
          const DVec3 place(frame.positions[i]);
          farthest = std::max(farthest, std::abs(truth.signedDistance(scene.cloud.origin + place, time_s)));
          crooked = std::max(crooked, std::abs(double{glm::length(frame.normals[i])} - 1));
          slow = std::max(slow, glm::distance(DVec3(frame.velocities[i]), pose.velocityAt(place)));
        }
        CHECK(farthest < 2e-5);
        CHECK(crooked < 1e-6);
        CHECK(slow < 1e-4);
      }
    }
}

TEST_CASE("frames of a moving shape at the same time are the same bit by bit, whatever was requested before") {
  const Scene scene = makeScene("sphere", 1'000);
  for (const RigidMotion& motion : motions()) {
    MovingCloud source(scene.cloud, motion), other(scene.cloud, motion);
    CloudFrame first, again;
    source.makeFrame(0.25, first);
    for (const double time_s : {7.0, -1.0, 0.1}) other.makeFrame(time_s, again);
    other.makeFrame(0.25, again);
    CHECK(first.positions == again.positions);
    CHECK(first.normals == again.normals);
    CHECK(first.velocities == again.velocities);
  }
}

}  // namespace palpate::rigid_motion_test
