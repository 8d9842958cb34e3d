// Hands in matter feel what the simulation computes, at any rate, and nothing after it has failed.
#include "engine/matter/matter_touch.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/core/error.hpp"
#include "engine/matter/matter_world.hpp"
#include "tests/near.hpp"

namespace palpate::matter_touch_test {

namespace {

// Small, and as deep as wide, so that a ball of two spacings submerges.
MatterScene tank() {
  MatterScene scene{.box_mm = {80, 120, 80}, .fill_mm = {80, 70, 80}, .spacing_mm = 10};
  scene.tool = usualTool({.box_mm = DVec3(50), .spacing_mm = 10});
  return scene;
}

std::unique_ptr<MatterSimulation> worldOf(const MatterScene& scene, const MatterTouchOptions& options) {
  return std::make_unique<MatterWorld>(scene, MatterOptions{.threads = options.threads, .tools = options.hands});
}

MatterTouch touched(const MatterScene& scene, const MatterTouchOptions& options = {}) {
  return MatterTouch(worldOf(scene, options), options);
}

// Down into the water, in a slow arc.
Pose dive(double time_s) {
  const double depth = std::min(time_s / 0.3, 1.0);
  return {.time_s = time_s, .hip = {40 + 5 * std::sin(9 * time_s), 100 - 65 * depth, 40}};
}

std::vector<Contact> played(MatterTouch& touch, double rate_Hz, double until_s) {
  std::vector<Contact> answers;
  for (int k = 0; k <= until_s * rate_Hz; ++k) answers.push_back(touch.query(dive(k / rate_Hz), 0));
  return answers;
}

PointCloud pointsOf(MatterTouch& touch, const MatterScene& scene) {
  PointCloud cloud = cloudOf(scene, nullptr, 1);
  touch.finish();
  touch.readBack(cloud);
  return cloud;
}

}  // namespace

TEST_CASE("a hand feels the force of its ball, and the cloud has the simulation's particles") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene, {.threads = 2});
  MatterWorld world(scene, {.threads = 1, .tools = 1});
  bool felt = false;
  for (int k = 0; k < 400; ++k) {
    const Pose pose = dive(1e-3 * k);
    const Contact contact = touch.query(pose, 0);
    const HandPose hand{.place_m = 1e-3 * pose.hip};
    world.step({&hand, 1});
    const ToolAnswer& answer = world.answers().front();
    CHECK(contact.valid);
    CHECK(contact.fresh);
    const bool pushed = glm::length(answer.reaction_N) > 1e-6;
    CHECK(contact.touching == pushed);
    if (!pushed) continue;
    felt = true;
    REQUIRE(contact.force_N);
    CHECK(*contact.force_N == answer.force_N);
    CHECK(glm::distance(contact.proxy, 1e3 * answer.place_m) < 1e-9);
    CHECK(glm::distance(contact.velocity, 1e3 * answer.velocity_m_s) < 1e-9);
    CHECK(glm::length(contact.normal) == near(1, 1e-6));
  }
  CHECK(felt);
  const PointCloud cloud = pointsOf(touch, scene);
  const std::vector<Vec3> places = world.positionsById();
  REQUIRE(cloud.size() == places.size());
  for (std::size_t i = 0; i < places.size(); ++i) CHECK(glm::distance(cloud.positions[i], 1e3f * places[i]) < 1e-3f);
}

TEST_CASE("a ball under water has the buoyancy of the displaced water, at any gain") {
  MatterScene scene = tank();
  for (const double gain : {1.0, 5.0}) {
    scene.gain = gain;
    MatterTouch touch = touched(scene);
    played(touch, 1000, 0.6);
    DVec3 sum_N(0);
    for (int k = 0; k < 200; ++k) sum_N += *touch.query(dive(0.601 + 1e-3 * k), 0).force_N;
    const double displaced_kg = scene.tool.mass_kg;  // its mass equals that of the displaced water
    CHECK(sum_N.y / 200 == near(gain * 9.81 * displaced_kg, 0.1));
  }
}

TEST_CASE("if a device outputs half of a force, half of its energy counts, and the force stays the same") {
  const MatterScene scene = tank();
  MatterTouch all = touched(scene), half = touched(scene);
  for (int k = 0; k < 300; ++k) {
    Pose pose = dive(1e-3 * k);
    const Contact first = all.query(pose, 0);
    pose.felt = {.asked_N = 4, .got_N = 2};
    CHECK(half.query(pose, 0).force_N == first.force_N);
  }
  const double whole_J = all.simulation()->portEnergies().front().now_J;
  CHECK(whole_J > 1e-3);
  CHECK(half.simulation()->portEnergies().front().now_J == near(whole_J / 2, 1e-12));
  CHECK(FeltForce{}.share() == 1);
  CHECK(FeltForce{.asked_N = 4, .got_N = 2}.share(2) == 1);
  CHECK(FeltForce{.asked_N = 4, .got_N = 0}.share(2) == 0);
  CHECK(FeltForce{.asked_N = 0, .got_N = 0}.share() == 0);
}

TEST_CASE("the same poses give the same results bit by bit with any number of threads, and at any rate time is right") {
  const MatterScene scene = tank();
  MatterTouch one = touched(scene, {.threads = 1}), three = touched(scene, {.threads = 3});
  const auto a = played(one, 1000, 0.3), b = played(three, 1000, 0.3);
  for (std::size_t k = 0; k < a.size(); ++k) CHECK(a[k].proxy == b[k].proxy);
  const PointCloud first = pointsOf(one, scene), second = pointsOf(three, scene);
  CHECK(first.positions == second.positions);
  CHECK(first.normals == second.normals);
  for (const double rate_Hz : {250.0, 500.0, 2000.0}) {
    CAPTURE(rate_Hz);
    MatterTouch other = touched(scene);
    played(other, rate_Hz, 0.3);
    const PointCloud there = pointsOf(other, scene);
    // The hand moves along other chords between its poses, so that the water differs slightly.
    double squares = 0;
    for (std::size_t i = 0; i < there.size(); ++i) {
      const double apart = glm::distance(there.positions[i], first.positions[i]);
      squares += apart * apart;
    }
    CHECK(std::sqrt(squares / static_cast<double>(there.size())) < 0.2 * scene.spacing_mm);
    MatterSteps steps(worldOf(scene, {}), 1, 0);
    for (int k = 0; k <= 0.3 * rate_Hz; ++k) steps.goTo({.time_s = k / rate_Hz, .hands = {}});
    CHECK(steps.world().time_s() == near(0.301, 1e-6));
  }
}

TEST_CASE("a paused scene does not move and gives no force; it resumes and resets on request") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene);
  played(touch, 1000, 0.3);
  const PointCloud before = pointsOf(touch, scene);
  SimulationControl& control = *touch.simulation();
  control.pause(true);
  for (int k = 301; k < 320; ++k) {
    const Contact contact = touch.query(dive(1e-3 * k), 0);
    CHECK(contact.valid);
    CHECK_FALSE(contact.touching);
  }
  CHECK(pointsOf(touch, scene).positions == before.positions);
  control.pause(false);
  touch.query(dive(0.32), 0);
  CHECK(pointsOf(touch, scene).positions != before.positions);
  control.reset();
  MatterTouch again = touched(scene);
  for (int k = 0; k < 30; ++k) {
    Pose pose = dive(1e-3 * k);
    again.query(pose, 0);
    pose.time_s += 0.321;
    touch.query(pose, 0);
  }
  CHECK(pointsOf(touch, scene).positions == pointsOf(again, scene).positions);
  CHECK(control.dropped_s() == 0);
}

TEST_CASE("the scene restarts when time goes back") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene), straight = touched(scene);
  played(touch, 1000, 0.2);
  played(touch, 1000, 0.05);
  played(straight, 1000, 0.05);
  CHECK(pointsOf(touch, scene).positions == pointsOf(straight, scene).positions);
}

TEST_CASE("a hand position that is not a number gives no answer and moves nothing") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene);
  played(touch, 1000, 0.2);
  const PointCloud before = pointsOf(touch, scene);
  const Contact none = touch.query({.time_s = 0.201, .hip = {std::numeric_limits<double>::quiet_NaN(), 0, 0}}, 0);
  CHECK_FALSE(none.valid);
  CHECK_FALSE(none.touching);
  CHECK(pointsOf(touch, scene).positions == before.positions);
}

TEST_CASE("in virtual time a frame contains each particle once, at its position after the last answer") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene);
  CloudFrame frame;
  CHECK_FALSE(touch.frames()->take(frame));  // nothing has moved yet
  for (const int ticks : {1, 40, 3}) {
    CAPTURE(ticks);
    double time_s = frame.time_s;
    for (int k = 0; k < ticks; ++k) touch.query(dive(time_s += 1e-3), 0);
    REQUIRE(touch.frames()->take(frame));
    CHECK(frame.time_s == near(time_s, 1e-6));
    const PointCloud cloud = pointsOf(touch, scene);
    CHECK(frame.positions == cloud.positions);
    CHECK(frame.velocities.size() == cloud.size());
    CHECK_FALSE(touch.frames()->take(frame));
  }
}

TEST_CASE("a simulation switches between virtual and real time on request, and continues from its state") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene, {.threads = 2});
  played(touch, 1000, 0.1);
  const PointCloud before = pointsOf(touch, scene);
  touch.begin(true, {});
  touch.begin(true, {});
  CHECK(pointsOf(touch, scene).positions == before.positions);
  for (int k = 101; k < 120; ++k) touch.query(dive(1e-3 * k), 100'000);
  touch.query(dive(0.4), 100'000);  // far behind the clock: it skips the missed time
  touch.finish();
  CHECK(touch.simulation()->dropped_s() > 0.2);
  touch.begin(false, {});
  const double dropped_s = touch.simulation()->dropped_s();
  touch.query(dive(0.5), 0);
  CHECK(touch.simulation()->dropped_s() == dropped_s);  // now it simulates all the time
  CHECK(pointsOf(touch, scene).positions != before.positions);
}

TEST_CASE("a failed simulation gives no answer until it is reset") {
  // So fine and weightless that it takes one step at a time: its speed of sound is below the speed of the hand.
  MatterScene scene{.box_mm = DVec3(16), .fill_mm = DVec3(16), .spacing_mm = 2, .gravity_m_s2 = DVec3(0)};
  scene.tool = usualTool(scene);
  MatterTouch touch = touched(scene);
  const auto beat = [&](int k) {
    return touch.query({.time_s = 1e-3 * k, .hip = {8, 8 + (k % 4 < 2 ? 8 : -8), 8}}, 0);
  };
  int k = 0;
  while (k < 1000 && touch.simulation()->failure().empty()) beat(k++);
  REQUIRE(touch.simulation()->failure() == "has diverged");
  const Contact failed = beat(k++);
  CHECK_FALSE(failed.valid);
  CHECK_FALSE(failed.touching);
  CHECK_FALSE(failed.force_N);
  CHECK_THROWS_WITH_AS(touch.finish(), doctest::Contains("the simulation has diverged"), Error);
  touch.simulation()->reset();
  CHECK(beat(k).valid);
  CHECK_NOTHROW(touch.finish());
}

TEST_CASE("hands share the matter: the second one feels the effects of the first") {
  MatterScene scene = tank();
  scene.box_mm.x = scene.fill_mm.x = 160;
  MatterTouch two = touched(scene, {.hands = 2}), alone = touched(scene, {.hands = 1});
  CHECK(two.hands() == 2);
  const auto still = [](double time_s) { return Pose{.time_s = time_s, .hip = {120, 40, 40}}; };
  double most_N = 0;
  for (int k = 0; k < 500; ++k) {
    const double time_s = 1e-3 * k;
    const std::array poses{Pose{.time_s = time_s, .hip = {40 + 20 * std::sin(20 * time_s), 40, 40}}, still(time_s)};
    const DVec3 felt_N = two.query(poses, 0)[1].force_N.value_or(DVec3(0));
    const DVec3 alone_N = alone.query(still(time_s), 0).force_N.value_or(DVec3(0));
    most_N = std::max(most_N, glm::distance(felt_N, alone_N));
  }
  CHECK(most_N > 0.01);
}

TEST_CASE("frames show each particle once at its position, with normals that face out of the water") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene);
  CloudFrame frame;
  CHECK_FALSE(touch.frames()->take(frame));
  touch.query(dive(0), 0);
  REQUIRE(touch.frames()->take(frame));
  CHECK_FALSE(touch.frames()->take(frame));
  touch.query(dive(0.001), 0);
  REQUIRE(touch.frames()->take(frame));
  CHECK(frame.time_s == 0.001);
  const PointCloud cloud = pointsOf(touch, scene);
  REQUIRE(frame.size() == cloud.size());
  CHECK(frame.ids.empty());
  CHECK(frame.positions == cloud.positions);
  CHECK(frame.normals == cloud.normals);
  REQUIRE(frame.velocities.size() == cloud.size());
  std::size_t top = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 p(cloud.positions[i]);
    if (p.y < 60 || p.x < 30 || p.x > 50 || p.z < 30 || p.z > 50) continue;
    ++top;
    CHECK(cloud.normals[i].y > 0.99f);
  }
  CHECK(top == 4);
}

TEST_CASE("in real time no tick exceeds its budget, and an old answer fades out") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene, {.realtime = true});
  // Given all the time that it needs, each tick has its own answer, as in virtual time.
  MatterTouch exact = touched(scene);
  for (int k = 0; k < 350; ++k) {
    const Contact contact = touch.query(dive(1e-3 * k), 0);
    CHECK(contact.fresh);
    CHECK(contact.force_N == exact.query(dive(1e-3 * k), 0).force_N);
  }
  // Time that it did not get is skipped and reported.
  const Contact late = touch.query(dive(0.5), 0);
  CHECK(late.fresh);
  CHECK(touch.simulation()->dropped_s() == near(0.149, 1e-6));
  const Pose pose = dive(0.501);
  const double full_N = glm::length(touch.query(pose, 0).force_N.value_or(DVec3(0)));
  CHECK(full_N > 0.01);
  // Each time far ahead of simulated time, with no budget to wait for it.
  double least_N = full_N;
  bool stale = false;
  for (int k = 0; k < 40 && !stale; ++k) {
    const Stopwatch watch;
    const Contact contact = touch.query({.time_s = 0.531 + 0.03 * k, .hip = pose.hip}, 1);
    stale = !contact.fresh;
    if (stale) least_N = glm::length(contact.force_N.value_or(DVec3(0)));
  }
  CHECK(stale);
  CHECK(least_N == 0);
  touch.finish();
}

TEST_CASE("waiting for a simulation returns at once without a query, and otherwise waits for it") {
  const MatterScene scene = tank();
  MatterTouch touch = touched(scene, {.realtime = true});
  touch.finish();
  const PointCloud begin = cloudOf(scene, nullptr, 1);
  const auto fallen_mm = [&] {  // of a particle at the top
    return begin.positions.back().y - pointsOf(touch, scene).positions.back().y;
  };
  CHECK(std::abs(fallen_mm()) < 1e-4f);
  touch.query(dive(0), 1);
  CHECK(fallen_mm() > 1e-3f);
}

TEST_CASE("a brush for water is refused, and no brush is accepted") {
  MatterTouch touch = touched(tank());
  CHECK_THROWS_WITH_AS(touch.setBrush(BrushOptions{}), doctest::Contains("cannot be sculpted"), UsageError);
  CHECK_NOTHROW(touch.setBrush(std::nullopt));
  CHECK(touch.edits() == nullptr);
  CHECK_FALSE(touch.report().scope.edits);
}

}  // namespace palpate::matter_touch_test
