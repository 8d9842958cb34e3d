// Clouds that move, on each back end.
#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/core/clock.hpp"
#include "tests/labels.hpp"
#include "tests/touch/back_end.hpp"
#include "tests/touch/moving_scene.hpp"

namespace palpate::moving_test {

namespace {

template <class Fixture>
struct Moving : Fixture {
  std::unique_ptr<TouchBackend> make(const Scene& scene, CloudSource& source, double friction = 0) const {
    return Fixture::make(scene.cloud, {.radius = scene.radius, .friction = friction, .source = &source});
  }
};
using OnMoving = Moving<OnBackEnd>;
using OnMovingInCore = Moving<OnBackEndInCore>;

}  // namespace

TEST_CASE_FIXTURE(OnMoving, "an oscillating sphere under a hand at rest is felt at its present depth") {
  for (const DVec3 center : {DVec3(0), DVec3(1e6, -2e6, 3e6)}) {
    CAPTURE(center.x);
    const Scene scene = makeScene("sphere", 20'000, center);
    MovingCloud source(scene.cloud, oscillation());
    const auto touch = make(scene, source);
    const DVec3 hip = center + DVec3(0, 0, 50.2);
    const int ticks = onCpuOrGpu(150, 100);
    const auto contacts = feelAtRest(*touch, hip, ticks);
    touch->finish();
    const DepthError error =
        depthError(contacts, hip, MovingShape(*scene.shape, oscillation(), scene.cloud.origin), 0.2);
    CHECK(error.inside > onCpuOrGpu(40, 25));
    CHECK(error.inside < onCpuOrGpu(100, 55));
    CHECK(error.rms < 0.03);
    CHECK(error.wronglyFree == 0);
    CHECK(error.wronglyTouching == 0);
    if (kOnGpu) CHECK(touch->report().index.built >= 100);
  }
}

TEST_CASE_FIXTURE(OnMoving,
                  "the same path twice gives the same answers, and the points end at the source's positions") {
  const Scene scene = makeScene("sphere", onCpuOrGpu(3'000, 2'000));
  const int ticks = onCpuOrGpu(60, 40);
  const auto play = [&](unsigned threads) {
    MovingCloud source(scene.cloud, oscillation());
    const auto touch = OnBackEnd::make(scene.cloud, {.radius = scene.radius, .source = &source, .threads = threads});
    auto contacts = feelAtRest(*touch, {1, 2, 50}, ticks);
    touch->finish();
    PointCloud end = scene.cloud;
    CHECK(touch->readBack(end) == scene.cloud.size());
    CloudFrame frame, truth;
    CHECK(touch->frames()->take(frame));
    CHECK_FALSE(touch->frames()->take(frame));
    source.makeFrame(kTick_s * (ticks - 1), truth);
    CHECK(frame.positions == truth.positions);
    CHECK(frame.normals == truth.normals);
    CHECK(end.positions == truth.positions);
    return contacts;
  };
  CHECK(std::ranges::equal(play(1), play(3), sameAnswer));
}

// In real time, on a sphere of radius 50 whose next frame, which rises to the stylus, is made only when it is
// released.
TEST_CASE_FIXTURE(OnMoving, "in real time no tick waits for the making of a frame") {
  const Scene scene = makeScene("sphere", 2'000);
  HeldSource source(scene.cloud, {.kind = MotionKind::drift, .speed = 1000});
  const auto touch = make(scene, source);
  CloudFrame frame;
  CHECK(touch->frames()->take(frame));
  for (int i = 1; i <= 20; ++i) {
    const Contact contact = touch->query({.time_s = kTick_s * i, .hip = {0, 0, 50.5}}, 1e6);
    CHECK(contact.fresh);
    CHECK_FALSE(contact.touching);
    CHECK_FALSE(touch->frames()->take(frame));
    if (i == 1) source.waitUntilAsked();
  }
  source.letGo();
  touch->finish();
  CHECK(touch->frames()->take(frame));
  CHECK(frame.time_s == kTick_s);
  CHECK(touch->query({.time_s = 0.021, .hip = {0, 0, 50.5}}, 1e6).touching);
}

// Frames up to 20 ms old are felt at the surface's current position, and with its velocity.
TEST_CASE_FIXTURE(OnMovingInCore, "old frames are extrapolated to the present position of the surface" * kMoreInFull) {
  const Scene scene = makeScene("sphere", 20'000);
  const RigidMotion motion = oscillation(2, 2);
  SlowSource source(scene.cloud, motion, 0.02);
  const auto touch = make(scene, source);
  const DVec3 hip(0, 0, 50.2);
  const int ticks = onCpuOrGpu(600, byTier(360, 600));
  const auto contacts = feelAtRest(*touch, hip, ticks);
  const DepthError error = depthError(contacts, hip, MovingShape(*scene.shape, motion), 0.2);
  CHECK(static_cast<int>(error.inside) > ticks / 3);
  CHECK(error.rms < 0.03);
  CHECK(error.wronglyFree == 0);
  CHECK(error.wronglyTouching == 0);
  for (std::size_t i = 100; i < contacts.size(); i += 20) {
    const RigidPose pose = motion.poseAt(kTick_s * static_cast<double>(i));
    if (contacts[i].touching) CHECK(glm::distance(contacts[i].velocity, pose.velocity) < 2);
  }
}

// After the last frame the surface continues for a while, then stands still.
TEST_CASE_FIXTURE(OnMovingInCore, "the surface stops some time after the last frame") {
  const Scene scene = makeScene("plane", 10'000);
  const RigidMotion motion{.kind = MotionKind::drift, .axis = {0, 0, -1}, .speed = 10};
  SlowSource source(scene.cloud, motion, 1e6);
  const auto touch = make(scene, source);
  touch->query({.time_s = 0, .hip = {0, 0, 1}}, 0);
  const double until_s = kMaxPointsAge_s;
  for (int i = 1; i < 200; ++i) {
    const double time_s = kTick_s * i;
    const Contact contact = touch->query({.time_s = time_s, .hip = {0, 0, -2}}, 0);
    CHECK(contact.touching);
    if (i > 2) CHECK(std::abs(contact.proxy.z + 10 * std::min(time_s, until_s)) < 0.02);
  }
}

// Friction depends on the relative slide: a hand at rest on a plane that moves below it is dragged as far as the cone
// allows, and a hand that moves along is not dragged.
TEST_CASE_FIXTURE(OnMovingInCore, "a sliding surface carries the proxy along, and only relative motion drags it") {
  const Scene scene = makeScene("plane", 20'000);
  constexpr double kSpeed = 100, kFriction = 0.5, kDepth = 1;
  MovingCloud source(scene.cloud, {.kind = MotionKind::drift, .axis = {1, 0, 0}, .speed = kSpeed});
  for (const double handSpeed : {0.0, kSpeed, -kSpeed}) {
    CAPTURE(handSpeed);
    const auto touch = make(scene, source, kFriction);
    Contact contact;
    DVec3 hip;
    for (int i = 0; i < 60; ++i) {
      hip = {handSpeed * kTick_s * i, 0.3, std::max(1 - 0.1 * i, -kDepth)};
      contact = touch->query({.time_s = kTick_s * i, .hip = hip}, 0);
    }
    REQUIRE(contact.touching);
    const DVec3 drag = contact.proxy - hip;
    CHECK(std::abs(drag.z - kDepth) < 0.01);
    CHECK(std::abs(drag.y) < 0.01);
    if (handSpeed == kSpeed)
      CHECK(std::abs(drag.x) < 0.02);
    else
      CHECK(std::abs(drag.x - kFriction * kDepth) < 0.05);
    CHECK(glm::distance(contact.velocity, DVec3(kSpeed, 0, 0)) < 1e-3);
  }
}

// A sheet that approaches at half a metre per second and carries the stylus along for 20 mm never lets it through; a
// stylus that it leaves behind is free at once.
TEST_CASE_FIXTURE(OnMovingInCore,
                  "a sheet approaching at half a metre per second cannot pass a stylus, from either face") {
  const Scene scene = makeScene("plane", 30'000);
  constexpr double kSpeed = 500;
  for (const double sign : {1.0, -1.0}) {
    CAPTURE(sign);
    MovingCloud source(scene.cloud, {.kind = MotionKind::drift, .axis = {0, 0, sign}, .speed = kSpeed});
    const auto touch = make(scene, source);
    const double start = 5.3;
    int touched = 0, through = 0, wrong = 0;
    for (int i = 0; i < 40; ++i) {
      const double surface = sign * kSpeed * kTick_s * i, hip = sign * start;  // the sheet has two faces
      const Contact contact = touch->query({.time_s = kTick_s * i, .hip = {0.2, 0.1, hip}}, 0);
      const double depth = sign * (surface - hip);
      if (depth > 0.02) {
        ++touched;
        through += !contact.touching || sign * (contact.proxy.z - surface) < -0.05 ||
                   std::abs(contact.proxy.z - surface) > 0.05;
      } else if (depth < -0.02) {
        wrong += contact.touching;
      }
    }
    CHECK(touched > 25);
    CHECK(through == 0);
    CHECK(wrong == 0);
  }
}

// An object that disappears between two frames is not felt from that tick on; an object that reappears is felt again
// by a stylus that approaches from outside.
TEST_CASE_FIXTURE(OnMovingInCore, "an object that leaves is no longer felt from that tick on") {
  const Scene scene = makeScene("sphere", 5'000);
  const double gone_s = 0.0205, back_s = 0.0405;
  for (const bool namesIds : {true, false}) {
    PartialSource source(
        scene.cloud, [&](double time_s, std::uint32_t) { return time_s < gone_s || time_s > back_s; }, namesIds);
    const auto touch = make(scene, source, 0.3);
    for (int i = 0; i < 70; ++i) {
      const double time_s = kTick_s * i, z = i < 50 ? std::max(51 - 0.2 * i, 49.0) : 51 - 0.2 * (i - 50);
      const Contact contact = touch->query({.time_s = time_s, .hip = {0, 0, z}}, 0);
      CAPTURE(i);
      CHECK(contact.valid);
      if (time_s > gone_s && time_s < back_s) {
        CHECK_FALSE(contact.touching);
        CHECK(contact.proxy == DVec3(0, 0, z));
        CHECK(contact.neighbours == 0);
      }
      if (i == 19 || i == 69) CHECK(contact.touching);
    }
    touch->finish();
  }
}

// A frame with holes is felt as the cloud of its points, bit by bit, and read back as it was shown.
TEST_CASE_FIXTURE(OnMoving, "a frame with holes is felt with the points that it has") {
  const Scene scene = makeScene("torus", 4'000);
  const auto shown = [](double, std::uint32_t id) { return id % 3 != 0 && id > 100; };
  PartialSource source(scene.cloud, shown);
  CloudFrame part;
  source.makeFrame(0, part);
  Scene rest{.shape = makeShape("torus", 100.0, DVec3(0)), .spacing = scene.spacing, .radius = scene.radius};
  rest.cloud.positions = part.positions;
  rest.cloud.normals = part.normals;
  MovingCloud still(rest.cloud, {});
  const auto some = make(scene, source), alone = make(rest, still);
  std::size_t touched = 0, other = 0;
  for (const DVec3& hip : wanderingPath(scene, 80, 0.5 * scene.radius, 3)) {
    const Contact a = some->query({.hip = hip}, 0), b = alone->query({.hip = hip}, 0);
    touched += a.touching;
    other += glm::distance(a.proxy, b.proxy) > 1e-4 || a.touching != b.touching || a.neighbours != b.neighbours;
  }
  CHECK(touched > 5);
  CHECK(other == 0);
  some->finish();
  CloudFrame seen;
  CHECK(some->frames()->take(seen));
  CHECK(seen.positions == part.positions);
  CHECK(seen.ids == part.ids);
  CHECK(seen.colors == part.colors);
  PointCloud end = scene.cloud;
  CHECK(some->readBack(end) == part.size());
  CHECK(end.positions == part.positions);
  CHECK(end.colors.at(1)[2] == 7);
}

TEST_CASE_FIXTURE(OnMovingInCore, "a rotating or drifting sphere is felt at its present depth") {
  const Scene scene = makeScene("bumpy-sphere", 20'000);
  const DVec3 start(0, 0, 60);
  for (const RigidMotion& motion : {RigidMotion{.kind = MotionKind::turn, .axis = {0.6, 0, 0.8}, .frequency_Hz = 0.3},
                                    RigidMotion{.kind = MotionKind::drift, .axis = {1, 0, 0}, .speed = 100}}) {
    MovingCloud source(scene.cloud, motion);
    const auto touch = make(scene, source);
    const MovingShape truth(*scene.shape, motion);
    const DVec3 hip = scene.shape->closest(start).position - DVec3(0, 0, 1);
    // Enters from outside first, since a HIP that starts inside is not caught.
    for (int i = 0; i < 20; ++i) touch->query({.time_s = 0, .hip = glm::mix(start, hip, 0.05 * i)}, 0);
    const auto contacts = feelAtRest(*touch, hip, 60);
    const DepthError error = depthError(contacts, hip, truth, 0.3);
    CHECK(error.inside > 40);
    CHECK(error.wronglyFree == 0);
    CHECK(error.rms < 0.12);  // the average rounds off its bumps slightly
  }
}

TEST_CASE_FIXTURE(OnMoving, "a source at rest gives the same answers as no source, bit by bit") {
  const Scene scene = makeScene("torus", 5'000, DVec3(100, 7, -3));
  for (const RigidMotion& still : {RigidMotion{}, RigidMotion{.kind = MotionKind::turn, .centre = {3, 2, 1}}}) {
    MovingCloud source(scene.cloud, still);
    const auto moving = make(scene, source);
    const auto alone = OnBackEnd::make(scene.cloud, {.radius = scene.radius});
    std::size_t touched = 0, other = 0;
    for (const DVec3& hip : wanderingPath(scene, onCpuOrGpu(150, 80), 0.5 * scene.radius, 3)) {
      const Contact a = moving->query({.hip = hip}, 0), b = alone->query({.hip = hip}, 0);
      touched += a.touching;
      other += !sameAnswer(a, b);
    }
    CHECK(touched > onCpuOrGpu<std::size_t>(15, 5));
    CHECK(other == 0);
  }
}

TEST_CASE_FIXTURE(OnMoving, "clouds of one or no point can move, without a surface") {
  for (const std::size_t count : onCpuOrGpu<std::vector<std::size_t>>({0, 1}, {1})) {
    PointCloud cloud;
    cloud.positions.assign(count, Vec3(0));
    cloud.normals.assign(count, Vec3(0, 0, 1));
    MovingCloud source(cloud, oscillation());
    const auto touch = OnBackEnd::make(cloud, {.radius = 1, .source = &source});
    for (const Contact& contact : feelAtRest(*touch, DVec3(0, 0, 0.5), 50)) CHECK(contact.valid);
  }
}

TEST_CASE_FIXTURE(OnMoving, "an inconsistent frame ends the session: no answer is valid from then on") {
  const Scene scene = makeScene("sphere", 1'000);
  for (const auto fault :
       {BrokenSource::Fault::notANumber, BrokenSource::Fault::infiniteNormal, BrokenSource::Fault::tooFew})
    for (const double budget_us : {0.0, 20'000.0}) {
      BrokenSource source(scene.cloud, fault, 0.02);
      const auto touch = make(scene, source);
      int lost = 0, early = 0;
      // In real time the frame arrives beside the ticks, whenever a loaded machine has made it.
      const Stopwatch since;
      for (int i = 0; lost < 5 && (i < 100 || (budget_us > 0 && since.elapsed_s() < 60)); ++i) {
        const Contact contact = touch->query({.time_s = kTick_s * i, .hip = {0, 0, 51}}, budget_us);
        if (contact.lost) ++lost;
        CHECK(contact.valid == !contact.lost);
        early += contact.lost && i < 20;
        if (budget_us > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      CHECK(lost == 5);
      CHECK(early == 0);
      CHECK_THROWS_AS(touch->finish(), Error);
    }
}

TEST_CASE_FIXTURE(OnMoving, "in real time frames are applied between ticks, in order") {
  const Scene scene = makeScene("sphere", 2'000);
  MovingCloud source(scene.cloud, oscillation());
  const auto touch = make(scene, source);
  CloudFrame frame;
  double last_s = -1;
  int frames = 0, fresh = 0;
  const Stopwatch since;
  for (int i = 0; i < 100 || ((frames <= 5 || fresh <= 3) && since.elapsed_s() < 30); ++i) {
    const Contact contact = touch->query({.time_s = kTick_s * i, .hip = {0, 0, 51}}, 20'000);
    CHECK(contact.valid);
    fresh += contact.fresh;
    if (!touch->frames()->take(frame)) continue;
    CHECK(frame.time_s >= last_s);
    last_s = frame.time_s;
    ++frames;
  }
  CHECK(frames > 5);
  CHECK(fresh > 3);
  touch->finish();
  CHECK(touch->report().index.built >= static_cast<std::uint64_t>(frames - 1));
  touch->frames()->take(frame);
  CloudFrame truth;
  source.makeFrame(frame.time_s, truth);
  CHECK(frame.positions == truth.positions);
}

}  // namespace palpate::moving_test
