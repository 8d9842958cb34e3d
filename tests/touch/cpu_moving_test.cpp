// Clouds that move, on the CPU; moving_test.cpp has the cases of each back end.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/touch/cpu_touch.hpp"
#include "tests/touch/moving_scene.hpp"

namespace palpate::cpu_moving_test {

TEST_CASE("a rotating or drifting sphere is felt at its present depth on the CPU") {
  const Scene scene = makeScene("bumpy-sphere", 20'000);
  const DVec3 start(0, 0, 60);
  for (const RigidMotion& motion : {RigidMotion{.kind = MotionKind::turn, .axis = {0.6, 0, 0.8}, .frequency_Hz = 0.3},
                                    RigidMotion{.kind = MotionKind::drift, .axis = {1, 0, 0}, .speed = 100}}) {
    MovingCloud source(scene.cloud, motion);
    CpuTouch touch(scene.cloud, {.radius = scene.radius, .threads = 1, .source = &source});
    const MovingShape truth(*scene.shape, motion);
    const DVec3 hip = scene.shape->closest(start).position - DVec3(0, 0, 1);
    // Enters from outside first, since a HIP that starts inside is not caught.
    for (int i = 0; i < 20; ++i) touch.query({.time_s = 0, .hip = glm::mix(start, hip, 0.05 * i)}, 0);
    const auto contacts = feelAtRest(touch, hip, 60);
    const DepthError error = depthError(contacts, hip, truth, 0.3);
    CHECK(error.inside > 40);
    CHECK(error.wronglyFree == 0);
    CHECK(error.rms < 0.12);  // the average rounds off its bumps slightly
  }
}

TEST_CASE("a source at rest gives the same answers on the CPU as no source, bit by bit") {
  const Scene scene = makeScene("torus", 5'000, DVec3(100, 7, -3));
  for (const RigidMotion& still : {RigidMotion{}, RigidMotion{.kind = MotionKind::turn, .centre = {3, 2, 1}}}) {
    MovingCloud source(scene.cloud, still);
    CpuTouch moving(scene.cloud, {.radius = scene.radius, .threads = 1, .source = &source});
    CpuTouch alone(scene.cloud, {.radius = scene.radius, .threads = 1});
    std::size_t touched = 0, other = 0;
    for (const DVec3& hip : wanderingPath(scene, 150, 0.5 * scene.radius, 3)) {
      const Contact a = moving.query({.hip = hip}, 0), b = alone.query({.hip = hip}, 0);
      touched += a.touching;
      other += !sameAnswer(a, b);
    }
    CHECK(touched > 15);
    CHECK(other == 0);
  }
}

TEST_CASE("an inconsistent frame ends the session on the CPU: no answer is valid from then on") {
  const Scene scene = makeScene("sphere", 2'000);
  for (const auto fault :
       {BrokenSource::Fault::notANumber, BrokenSource::Fault::infiniteNormal, BrokenSource::Fault::tooFew}) {
    BrokenSource source(scene.cloud, fault, 0.05);
    CpuTouch touch(scene.cloud, {.radius = scene.radius, .threads = 1, .source = &source});
    const auto contacts = feelAtRest(touch, {0, 0, 51}, 100);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      CHECK(contacts[i].valid == (i < 50));
      CHECK(contacts[i].lost == (i >= 50));
    }
    CHECK_THROWS_AS(touch.finish(), Error);
  }
}

TEST_CASE("clouds of one or no point can move on the CPU, without a surface") {
  for (const std::size_t count : {0, 1}) {
    PointCloud cloud;
    cloud.positions.assign(count, Vec3(0));
    cloud.normals.assign(count, Vec3(0, 0, 1));
    MovingCloud source(cloud, oscillation());
    CpuTouch touch(cloud, {.radius = 1, .source = &source});
    for (const Contact& contact : feelAtRest(touch, DVec3(0, 0, 0.5), 50)) CHECK(contact.valid);
  }
}

TEST_CASE("in real time frames are applied between ticks on the CPU, in order") {
  const Scene scene = makeScene("sphere", 20'000);
  MovingCloud source(scene.cloud, oscillation());
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .threads = 1, .source = &source});
  CloudFrame frame;
  double last_s = -1, latest_s = 0;
  int frames = 0;
  for (int i = 0; i < 300 || (frames <= 20 && i < 20'000); ++i) {
    latest_s = kTick_s * i;
    CHECK(touch.query({.time_s = latest_s, .hip = {0, 0, 50.5}}, 800).valid);
    touch.prepare();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (!touch.frames()->take(frame)) continue;
    CHECK(frame.time_s >= last_s);
    last_s = frame.time_s;
    ++frames;
  }
  CHECK(frames > 20);
  touch.finish();
  CHECK(touch.report().index.built >= static_cast<std::uint64_t>(frames - 1));
}

}  // namespace palpate::cpu_moving_test
