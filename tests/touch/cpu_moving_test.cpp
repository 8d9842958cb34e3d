// Clouds that move, on the CPU. Needs no GPU.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/touch/cpu_touch.hpp"
#include "tests/touch/moving_scene.hpp"
#include "tests/touch/stream_scene.hpp"

namespace palpate::cpu_moving_test {

namespace {

std::unique_ptr<TouchBackend> makeCpu(const Scene& scene, CloudSource& source, double friction) {
  return std::make_unique<CpuTouch>(
      scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = friction, .threads = 1, .source = &source});
}

std::unique_ptr<TouchBackend> makeCpuOnStream(const PointCloud& first, CloudSource& source, double radius) {
  return std::make_unique<CpuTouch>(first, CpuTouchOptions{.radius = radius, .threads = 1, .source = &source});
}

}  // namespace

TEST_CASE("an oscillating sphere under a hand at rest is felt at its present depth on the CPU") {
  for (const DVec3 center : {DVec3(0), DVec3(1e6, -2e6, 3e6)}) {
    CAPTURE(center.x);
    const Scene scene = makeScene("sphere", 20'000, center);
    MovingCloud source(scene.cloud, oscillation());
    CpuTouch touch(scene.cloud, {.radius = scene.radius, .threads = 1, .source = &source});
    const DVec3 hip = center + DVec3(0, 0, 50.2);
    const auto contacts = feelAtRest(touch, hip, 150);
    const DepthError error =
        depthError(contacts, hip, MovingShape(*scene.shape, oscillation(), scene.cloud.origin), 0.2);
    CHECK(error.inside > 40);
    CHECK(error.inside < 100);
    CHECK(error.rms < 0.03);
    CHECK(error.wronglyFree == 0);
    CHECK(error.wronglyTouching == 0);
  }
}

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

TEST_CASE("the same path twice gives the same answers on the CPU, and the points end at the source's positions") {
  const Scene scene = makeScene("sphere", 3'000);
  const auto play = [&](unsigned threads) {
    MovingCloud source(scene.cloud, oscillation());
    CpuTouch touch(scene.cloud, {.radius = scene.radius, .threads = threads, .source = &source});
    auto contacts = feelAtRest(touch, {1, 2, 50}, 60);
    touch.finish();
    PointCloud end = scene.cloud;
    CHECK(touch.readBack(end) == scene.cloud.size());
    CloudFrame frame, truth;
    CHECK(touch.frames()->take(frame));
    CHECK_FALSE(touch.frames()->take(frame));
    source.makeFrame(kTick_s * 59, truth);
    CHECK(frame.positions == truth.positions);
    CHECK(frame.normals == truth.normals);
    CHECK(end.positions == truth.positions);
    return contacts;
  };
  CHECK(std::ranges::equal(play(1), play(3), sameAnswer));
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

TEST_CASE("in real time no tick on the CPU waits for the making of a frame") {
  const Scene scene = makeScene("sphere", 2'000);
  HeldSource source(scene.cloud, {.kind = MotionKind::drift, .speed = 1000});
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .threads = 1, .source = &source});
  checkNoTickWaits(touch, source);
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

TEST_CASE("old frames are extrapolated to the present position of the surface on the CPU") { checkOldFrames(makeCpu); }

TEST_CASE("on the CPU the surface stops some time after the last frame") { checkStoppedFrames(makeCpu); }

TEST_CASE("on the CPU a sliding surface carries the proxy along, and only relative motion drags it") {
  checkCarriedProxy(makeCpu);
}

TEST_CASE("a sheet approaching at half a metre per second cannot pass a stylus, from either face, on the CPU") {
  checkFastSheet(makeCpu);
}

TEST_CASE("an object that leaves is no longer felt from that tick on, on the CPU") { checkLeaving(makeCpu); }

TEST_CASE("on the CPU a frame with holes is felt with the points that it has") { checkHoles(makeCpu); }

TEST_CASE("on the CPU a wall that steps by a millimetre before a depth camera is felt as a ramp") {
  checkStepIsRamp(makeCpuOnStream);
}

TEST_CASE("on the CPU no frame of a tilted plane is felt as a step") { checkSteadyPlane(makeCpuOnStream); }

TEST_CASE("on the CPU a wall approaching a depth camera cannot pass a stylus") { checkComingWall(makeCpuOnStream); }

TEST_CASE("on the CPU a wall that leaves a depth camera's view is no longer felt") {
  checkLeavingWall(makeCpuOnStream);
}

}  // namespace palpate::cpu_moving_test
