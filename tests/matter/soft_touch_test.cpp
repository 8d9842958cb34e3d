// Soft bodies under hands on the CPU: the felt force equals the force on the body. Needs no GPU.
#include <limits>
#include <random>
#include <thread>

#include "engine/contact/surface.hpp"
#include "engine/core/error.hpp"
#include "tests/labels.hpp"
#include "tests/matter/soft_on_cpu.hpp"
#include "tests/near.hpp"

namespace palpate::soft_touch_test {

TEST_CASE("a flat plate that covers a bar feels the stiffness E A / L") {
  MatterScene scene = bareBlock();
  scene.fill_mm = {30, 60, 30};
  scene.friction = 0;
  scene.poisson = 0.3;
  // With friction the plate does not slip off the top's edges.
  SoftTouching options{.touch = {.tools = {flatPlate(6, 27)}, .friction = 1}};
  options.spring.stiffness_N_per_unit = 5;
  options.spring.most_N = 100;
  SoftScene bar = touched(scene, options);
  // Force, and mean displacement of the surface, at rest at a depth.
  const auto pressed = [&](double begin_s, double depth) {
    double force_N = 0, way = 0;
    for (int k = 0; k < 1200; ++k) {
      const double time_s = begin_s + 1e-3 * k;
      const double y = 60 - depth + 2 * std::max(0.0, 1 - 1e-3 * k / 0.3);
      bar.touch().query({.time_s = time_s, .hip = {50, y, 50}}, 0);
    }
    for (const PointContact& point : bar.touch().points(0)) {
      REQUIRE(point.contact.touching);
      force_N += point.share * 5 * (point.contact.proxy.y - point.hip.y);
      way += point.contact.proxy.y / static_cast<double>(bar.touch().points(0).size());
    }
    return std::pair(force_N, way);
  };
  const auto [lessForce_N, less] = pressed(0, 1.5);
  const auto [moreForce_N, more] = pressed(1.2, 3.5);
  const double stiffness_N_per_mm = 3e4 * 9e-4 / 0.06 * 1e-3;
  const double felt_N_per_mm = (moreForce_N - lessForce_N) / (less - more);
  CHECK(moreForce_N > 0.5);
  CHECK(felt_N_per_mm == near(stiffness_N_per_mm, 0.05));
}

TEST_CASE("a soft body's force grows with depth, stays below a rigid cloud's, and leaves no trace after release") {
  SoftScene block = touched(bareBlock());
  for (int k = 0; k < 200; ++k) block.touch().query({.time_s = 1e-3 * k, .hip = atDepth(-10)}, 0);
  const PointCloud before = block.points();
  double last_N = 0, deepest_N = 0;
  for (int k = 0; k <= 900; ++k) {
    const double time_s = 0.2 + 1e-3 * k;
    const double depth = -2 + 10 * std::min(k / 800.0, 1.0);
    const Contact contact = block.touch().query({.time_s = time_s, .hip = atDepth(depth)}, 0);
    CHECK(contact.valid);
    const double force_N = contact.touching ? 0.5 * (contact.proxy.y - atDepth(depth).y) : 0;
    if (depth < -0.5) CHECK(force_N == 0);
    if (k % 50 == 0 && depth > 0.5 && k <= 800) {
      CHECK(force_N > last_N);
      last_N = force_N;
    }
    deepest_N = std::max(deepest_N, force_N);
  }
  CHECK(deepest_N > 0.5);
  CHECK(deepest_N < 0.8 * 0.5 * 8);  // a rigid block would return all of that
  double deepest = 0;
  const PointCloud dented = block.points();
  for (std::size_t i = 0; i < dented.size(); ++i)
    deepest = std::max(deepest, static_cast<double>(before.positions[i].y - dented.positions[i].y));
  CHECK(deepest > 2);
  for (int k = 0; k < 1000; ++k) block.touch().query({.time_s = 1.2 + 1e-3 * k, .hip = atDepth(-10)}, 0);
  const PointCloud after = block.points();
  for (std::size_t i = 0; i < after.size(); ++i) CHECK(glm::distance(after.positions[i], before.positions[i]) < 0.1f);
}

TEST_CASE("a soft body receives the force that the hand feels, and momentum is conserved") {
  for (const double friction : {0.0, 0.6}) {
    CAPTURE(friction);
    SoftTouching options;
    options.touch.friction = friction;
    SoftScene block = touched(bareBlock(), options);
    FeltSpring spring(options.spring);
    DVec3 felt(0);
    // Down, then along the top under load.
    for (int k = 0; k < 800; ++k) {
      Pose pose = press(1e-3 * k, 6);
      pose.hip.x += 8 * std::max(0.0, 1e-3 * k - 0.4);
      felt += 1e-3 * spring.add(block.touch().query(pose, 0), pose.hip, 1e-3);
    }
    const MatterImpulses& given = block.world().impulses();
    CHECK(felt.y > 0.2);
    CHECK(std::abs(given.onTools.y - felt.y) < 0.01 * felt.y);
    CHECK(std::abs(given.onTools.x - felt.x) < 0.02 * felt.y);
    if (friction > 0) CHECK(felt.x < -0.02);
    const DVec3 missing = block.world().totals().momentum - (given.gravity - given.onWalls - given.onTools);
    CHECK(glm::length(missing) <= 1e-5 * (glm::length(given.gravity) + glm::length(given.onTools)));
  }
}

TEST_CASE("the same poses give the same results bit by bit with any number of threads, also after a restart") {
  SoftTouching options;
  options.threads = 1;
  SoftScene one = touched(bareBlock(), options);
  options.threads = 3;
  SoftScene three = touched(bareBlock(), options);
  const auto play = [](SoftScene& scene) {
    std::vector<DVec3> proxies;
    for (int k = 0; k < 300; ++k) proxies.push_back(scene.touch().query(press(1e-3 * k, 5, 0.2), 0).proxy);
    return proxies;
  };
  const auto first = play(one);
  CHECK(first == play(three));
  const PointCloud there = one.points();
  CHECK(there.positions == three.points().positions);
  CHECK(there.normals == three.points().normals);
  // A step back in time restarts everything; the hand is then free.
  CHECK(play(one) == first);
  CHECK(one.points().positions == there.positions);
}

TEST_CASE("random hands gain at most a millijoule from a soft body through its surface" * kMoreInFull) {
  std::mt19937 random(11);
  std::normal_distribution<double> push;
  for (const double viscosity : {0.0, 3.0}) {
    for (const double friction : {0.0, 0.5}) {
      CAPTURE(viscosity);
      CAPTURE(friction);
      if (!inFullTier() && (viscosity > 0) == (friction > 0)) continue;
      MatterScene scene = bareBlock();
      scene.viscosity_Pa_s = viscosity;
      SoftTouching options;
      options.touch.friction = friction;
      SoftScene block = touched(scene, options);
      FeltSpring spring(options.spring);
      DVec3 hip = atDepth(-1), speed(0), force(0);
      double energy_mJ = 0, least_mJ = 0, most_N = 0;
      for (int k = 0; k < byTier(1000, 2000); ++k) {
        speed = 0.98 * speed - DVec3(0, 3, 0);
        for (int axis = 0; axis < 3; ++axis) speed[axis] += 30 * push(random);
        const DVec3 next = glm::clamp(hip + 1e-3 * speed, DVec3(32, 30, 32), DVec3(68, 50, 68));
        const DVec3 now = spring.add(block.touch().query({.time_s = 1e-3 * k, .hip = next}, 0), next, 1e-3);
        // Energy that the surface absorbs: mean of the forces at both ends of the displacement.
        energy_mJ -= glm::dot((force + now) / 2.0, next - hip);
        least_mJ = std::min(least_mJ, energy_mJ);
        force = now;
        hip = next;
        most_N = std::max(most_N, glm::length(now));
      }
      CHECK(block.touch().simulation()->failure().empty());
      CHECK(least_mJ >= -1);
      CHECK(most_N > 0.5);
    }
  }
}

TEST_CASE("the energy of a pressing hand matches the force that it feels, at any gain") {
  for (const double gain : {1.0, 8.0}) {
    CAPTURE(gain);
    MatterScene scene = bareBlock();
    scene.gain = gain;
    scene.pinned_mm = {DVec3(0), DVec3(100, 0.1, 100)};
    const SoftTouching options;
    SoftScene block = touched(scene, options);
    FeltSpring spring(options.spring);
    DVec3 before = atDepth(-1), force(0);
    double work_mJ = 0;
    for (int k = 0; k < 600; ++k) {
      const DVec3 hip = atDepth(-1 + 0.01 * k);
      const DVec3 now = spring.add(block.touch().query({.time_s = 1e-3 * k, .hip = hip}, 0), hip, 1e-3);
      work_mJ -= glm::dot((force + now) / 2.0, hip - before);
      force = now;
      before = hip;
    }
    REQUIRE(work_mJ > 1);
    const PortEnergy port = block.touch().simulation()->portEnergies().front();
    CHECK(1e3 * port.now_J == near(work_mJ, 0.1));
  }
}

TEST_CASE("two hands press one body: each feels the other, and the body receives both forces") {
  SoftTouching options;
  options.touch.tools.resize(2);
  SoftScene both = touched(bareBlock(), options), alone = touched(bareBlock(), options);
  std::array<FeltSpring, 2> springs{FeltSpring(options.spring), FeltSpring(options.spring)};
  DVec3 felt(0);
  double apart_N = 0;
  for (int k = 0; k < 600; ++k) {
    const double time_s = 1e-3 * k;
    std::array<Pose, 2> poses{press(time_s, 4), press(time_s, 8)};
    poses[0].hip.x = 40;
    poses[1].hip.x = 60;
    const auto answers = both.touch().query(poses, 0);
    const DVec3 first = springs[0].add(answers[0], poses[0].hip, 1e-3);
    felt += 1e-3 * (first + springs[1].add(answers[1], poses[1].hip, 1e-3));
    poses[1].hip.y = 60;
    const Contact single = alone.touch().query(poses, 0)[0];
    if (single.touching) apart_N = std::max(apart_N, glm::distance(first, 0.5 * (single.proxy - poses[0].hip)));
  }
  CHECK(std::abs(both.world().impulses().onTools.y - felt.y) < 0.01 * felt.y);
  CHECK(apart_N > 0.02);
}

TEST_CASE("a hand's force is limited to its maximum, and so is the body's") {
  SoftTouching options;
  options.spring = {.stiffness_N_per_unit = 4, .damping_N_s_per_unit = 0, .most_N = 0.4};
  SoftScene block = touched(bareBlock(), options);
  for (int k = 0; k < 700; ++k) block.touch().query(press(1e-3 * k, 6), 0);
  const DVec3 before = block.world().impulses().onTools;
  for (int k = 700; k < 1700; ++k) block.touch().query(press(1e-3 * k, 6), 0);
  CHECK((block.world().impulses().onTools - before).y == near(0.4, 0.01));
}

TEST_CASE("a paused soft scene does not move and gives no force; it resumes and restarts on request") {
  SoftScene block = touched(bareBlock());
  int k = 0;
  const auto ask = [&](double depth) { return block.touch().query({.time_s = 1e-3 * k++, .hip = atDepth(depth)}, 0); };
  for (int i = 0; i < 300; ++i) ask(-2 + 0.02 * i);
  CHECK(ask(4).touching);
  const PointCloud dented = block.points();
  SimulationControl& control = *block.touch().simulation();
  control.pause(true);
  for (int i = 0; i < 20; ++i) CHECK_FALSE(ask(4).touching);
  CHECK(block.points().positions == dented.positions);
  control.pause(false);
  for (int i = 0; i < 200; ++i) CHECK_FALSE(ask(4).touching);  // inside, as before: the body closes about it
  CHECK(block.points().positions != dented.positions);
  for (int i = 0; i < 20; ++i) ask(-2);
  for (int i = 0; i < 200; ++i) ask(-2 + 0.03 * i);
  CHECK(ask(4).touching);
  control.reset();
  for (int i = 0; i < 30; ++i) CHECK_FALSE(ask(4).touching);
  CHECK(block.world().time_s() < 0.04);
  CHECK(control.dropped_s() == 0);
}

TEST_CASE("a hand that is not a number gets no answer, and a failed body gives none until its restart") {
  SoftScene block = touched(bareBlock());
  for (int k = 0; k < 300; ++k) block.touch().query(press(1e-3 * k, 4, 0.2), 0);
  const PointCloud before = block.points();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(block.touch().query({.time_s = 0.3, .hip = {nan, 0, 0}}, 0).valid);
  CHECK(block.points().positions == before.positions);
  CHECK(block.touch().query(press(0.301, 4, 0.2), 0).valid);
  for (const BrushKind kind : {BrushKind::carve, BrushKind::paint})
    CHECK_THROWS_WITH_AS(block.touch().setBrush(BrushOptions{.kind = kind, .radius = 10}),
                         doctest::Contains("cannot change the shape"), UsageError);
  CHECK_FALSE(block.touch().report().scope.edits);
}

TEST_CASE("for points older than the tick the surface yields with the body's compliance") {
  // Ticks are four times as frequent as steps: three of four feel earlier points.
  const SoftTouching options;
  SoftScene block = touched(bareBlock(), options);
  int k = 0;
  const auto ask = [&](double depth) {
    return block.touch().query({.time_s = 2.5e-4 * k++, .hip = atDepth(depth)}, 0);
  };
  for (int i = 0; i < 800; ++i) ask(-2 + 6.0 * std::min(1.0, i / 400.0));
  while (k % 4 != 0) ask(4);
  const Contact fresh = ask(4);
  REQUIRE(fresh.touching);
  // A quarter of a millisecond later the hand is suddenly half a millimetre deeper.
  const Contact later = ask(4.5);
  const double yields = 0.5 * block.source().compliance(0);
  CHECK(yields > 0.2);
  const double gone = fresh.proxy.y - later.proxy.y;
  CHECK(gone == near(0.5 * yields / (1 + yields), 0.05));
  // As compliant as the body reports for this position.
  auto& world = const_cast<MatterSimulation&>(block.world());
  const double own = world.localCompliance_m_N(1e-3 * fresh.proxy, 0.5e-3 * block.radius(), {0, -1, 0}) * 1e3;
  CHECK(block.source().compliance(0) == near(own, 0.05));
  CHECK(block.source().compliance(0) !=
        SoftScene(bareBlock(), options, feltOnCpu).source().compliance(0));  // a half-space's
  // A hand that moves back finds the surface where it was.
  const Contact back = ask(3.5);
  CHECK(back.proxy.y == near(fresh.proxy.y, 1e-4));
}

TEST_CASE("after several steps at once the surface still yields with the body's compliance") {
  SoftScene block = touched(bareBlock());
  const double halfSpace = block.source().compliance(0);
  // Three and four steps alternately, every other time half a step after the last of them.
  for (int k = 0; k < 60; ++k) block.touch().query(press(3.5e-3 * k, 3, 0.05), 0);
  CHECK(block.source().compliance(0) != halfSpace);
}

TEST_CASE("in real time no tick waits for a step, late steps are dropped, and the body is still pressed") {
  SoftTouching options;
  options.realtime = true;
  SoftScene block = touched(bareBlock(), options);
  double most = 0;
  int ticks = 0;
  // Until the body has been pressed long enough, which takes more ticks on a slow machine.
  const auto simulated_s = [&] { return 1e-3 * ticks - block.touch().simulation()->dropped_s(); };
  for (; ticks < 500 || (simulated_s() < 0.4 && ticks < 20'000); ++ticks) {
    const Pose pose = press(1e-3 * ticks, 4, 0.2);
    const Contact contact = block.touch().query(pose, 500);
    CHECK(contact.valid);
    if (contact.touching) most = std::max(most, contact.proxy.y - pose.hip.y);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  block.touch().finish();
  CHECK(most > 0.5);
  CHECK(block.world().impulses().onTools.y > 0.01);
  CHECK(block.world().time_s() + block.touch().simulation()->dropped_s() == near(1e-3 * ticks, 0.1));
}

}  // namespace palpate::soft_touch_test
