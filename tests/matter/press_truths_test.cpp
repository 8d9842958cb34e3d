// Hands that press on the surface of a soft body, on each back end.
#include <array>
#include <limits>
#include <random>

#include "tests/labels.hpp"
#include "tests/matter/on_matter.hpp"
#include "tests/matter/pressing_hand.hpp"

namespace palpate::press_truths_test {

namespace {

// 30 x 20 x 30 mm in the centre of a box of 60 mm.
MatterScene smallBlock() {
  return {.matter = Matter::soft,
          .box_mm = {60, 60, 60},
          .fill_mm = {30, 20, 30},
          .spacing_mm = 5,
          .viscosity_Pa_s = 3,
          .young_Pa = 2e4};
}

// So soft that a step is one substep; without gravity.
MatterScene slowScene(const DVec3& fill_mm) {
  return {.matter = Matter::soft,
          .box_mm = DVec3(200, 100, 200),
          .fill_mm = fill_mm,
          .spacing_mm = 5,
          .viscosity_Pa_s = 0,
          .young_Pa = 20,
          .gravity_m_s2 = DVec3(0)};
}

DVec3 topOf(const MatterScene& scene) { return 1e-3 * DVec3(scene.box_mm.x / 2, scene.fill_mm.y, scene.box_mm.z / 2); }

double missingShare(const MatterSimulation& world) {
  const MatterImpulses& given = world.impulses();
  const DVec3 missing = world.totals().momentum - (given.gravity - given.onWalls - given.onTools);
  return glm::length(missing) / (glm::length(given.gravity) + glm::length(given.onTools));
}

}  // namespace

TEST_CASE_FIXTURE(OnSoft, "pressing hands receive the momentum that the body loses") {
  const int steps = onCpuOrGpu(200, 60);
  for (const bool pinned : {false, true}) {
    CAPTURE(pinned);
    MatterScene scene = smallBlock();
    if (pinned) scene.pinned_mm = {DVec3(0, 9, 0), DVec3(40, 60, 29)};
    const auto world = make(scene, 0, nullptr, {});
    const DVec3 top = topOf(scene);
    std::array hands{PressingHand(top - DVec3(0.002, 0, 0), 0.006), PressingHand(top + DVec3(0.004, 0, 0), 0.007, 1)};
    DVec3 felt(0);
    for (int k = 0; k < steps; ++k) {
      std::array<SurfacePress, 2> presses;
      for (std::size_t i = 0; i < 2; ++i)
        presses[i] = hands[i].goTo(hands[i].press().handTo_m + DVec3(1e-4, -1e-4 * (i + 1.0), 0));
      world->press(presses);
      world->step();
      REQUIRE(world->pressed().size() == 2);
      for (std::size_t i = 0; i < 2; ++i) {
        hands[i].heard(world->pressed()[i]);
        felt += world->pressed()[i].impulse;
      }
      REQUIRE(missingShare(*world) <= 1e-5);
    }
    REQUIRE(world->state() == MatterState::running);
    CHECK(felt.y > 1e-3);
    CHECK(felt.x < -1e-5);
    CHECK(glm::distance(world->impulses().onTools, felt) <= 1e-9 * glm::length(felt));
    CHECK(glm::length(world->impulses().onWalls) > 1e-4);
    // A press lasts one step only.
    world->step();
    CHECK(world->pressed().empty());
    CHECK(glm::distance(world->impulses().onTools, felt) <= 1e-9 * glm::length(felt));
  }
}

TEST_CASE_FIXTURE(OnSoft, "random pressing hands gain no energy from a soft body" * kFullOnGpu) {
  const int steps = onCpuOrGpu(600, 250);
  std::mt19937 random(5);
  std::normal_distribution<double> push;
  for (const double friction : {0.0, 0.6}) {
    CAPTURE(friction);
    MatterScene scene = smallBlock();
    scene.viscosity_Pa_s = friction == 0 ? 0 : 3;
    const auto world = make(scene, 0, nullptr, {});
    const DVec3 top = topOf(scene);
    PressingHand hand(top, 0.008);
    hand.press().friction = friction;
    DVec3 place = top, speed(0);
    double min_J = 0, most_N = 0;
    for (int k = 0; k < steps; ++k) {
      speed = 0.98 * speed - DVec3(0, 3e-3, 0);
      for (int axis = 0; axis < 3; ++axis) speed[axis] += 0.03 * push(random);
      place = glm::clamp(place + kMatterStep_s * speed, top - DVec3(0.006), top + DVec3(0.006));
      const SurfacePress press = hand.goTo(place);
      world->press({&press, 1});
      world->step();
      hand.heard(world->pressed()[0]);
      min_J = std::min(min_J, hand.work_J());
      most_N = std::max(most_N, glm::length(world->pressed()[0].force_N));
    }
    REQUIRE(world->state() == MatterState::running);
    checkAtMost(fmt::format("energy that random hands get out of a surface, friction {:g}, 0.5 N/mm, mJ", friction),
                1e3 * std::abs(min_J), 1);
    CHECK(most_N > 0.2);
  }
}

TEST_CASE_FIXTURE(OnSoft, "only the side of a sheet that faces the hand is pressed" * kPortable) {
  const MatterScene scene = slowScene({40, 5, 40});
  REQUIRE(planOf(scene).substeps == 1);
  const auto world = make(scene, 0, nullptr, {});
  const std::vector<Vec3> rest = world->positionsById();
  PressingHand hand(topOf(scene), 0.015);
  SurfacePress press = hand.goTo(topOf(scene) - DVec3(0, 1e-4, 0));
  world->press({&press, 1});
  world->step();
  const std::vector<Vec3> velocities = world->velocitiesById();
  double above = 0, below = 0;
  for (std::size_t i = 0; i < rest.size(); ++i)
    (rest[i].y > 0.0025f ? above : below) += static_cast<double>(glm::length(velocities[i]));
  CHECK(above > 1e-3);
  CHECK(below <= 1e-6 * above);
}

TEST_CASE_FIXTURE(OnSoft, "a press moves only the nodes within its reach" * kPortable) {
  const MatterScene scene = slowScene({85, 15, 70});
  const auto world = make(scene, 0, nullptr, {}), alone = make(scene, 0, nullptr, {});
  const std::vector<Vec3> rest = world->positionsById();
  const double radius = 0.009;
  const std::array places{topOf(scene) + DVec3(0.0313, 0, -0.0177), topOf(scene) - DVec3(0.0211, 0, 0.0193)};
  std::array<SurfacePress, 2> presses;
  for (std::uint32_t i = 0; i < 2; ++i) {
    PressingHand hand(places[i], radius, i);
    presses[i] = hand.goTo(places[i] - DVec3(0, 2e-4, 0));
  }
  world->press(presses);
  world->step();
  alone->step();
  // At rest velocities are zero only up to rounding.
  const std::vector<Vec3> velocities = world->velocitiesById(), still = alone->velocitiesById();
  const double spacing = scene.spacing_mm * 1e-3;
  int moved = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double away = std::min(glm::distance(DVec3(rest[i]), places[0]), glm::distance(DVec3(rest[i]), places[1]));
    if (away > radius + 1.8 * spacing) REQUIRE(velocities[i] == still[i]);
    const bool isTop = std::abs(static_cast<double>(rest[i].y) - 0.015) < 1e-6;
    if (isTop && away < 0.9 * radius) REQUIRE(velocities[i].y < still[i].y - 1e-8f);
    moved += velocities[i] != still[i] ? 1 : 0;
  }
  CHECK(moved > 15);
  CHECK(moved < 150);
}

TEST_CASE_FIXTURE(OnSoft, "the presses of one hand together stay below the hand's maximum force") {
  const int steps = onCpuOrGpu(120, 80);
  MatterScene scene = smallBlock();
  scene.pinned_mm = {DVec3(0), DVec3(60, 0.1, 60)};
  const auto world = make(scene, 0, nullptr, {});
  std::vector<PressingHand> hands;
  // A tool of three points with shared nodes, and another hand.
  for (int i = 0; i < 4; ++i) {
    hands.emplace_back(topOf(scene) + DVec3(0.004 * i - 0.008, 0, 0), 0.006, i < 3 ? 3 : 7);
    hands.back().press().most_N = i < 3 ? 0.3 : 0.9;
  }
  double most_N = 0, other_N = 0;
  for (int k = 0; k < steps; ++k) {
    std::vector<SurfacePress> presses;
    for (PressingHand& hand : hands) presses.push_back(hand.goTo(hand.press().handTo_m - DVec3(0, 0.006 / steps, 0)));
    world->press(presses);
    world->step();
    DVec3 sum(0);
    for (std::size_t i = 0; i < hands.size(); ++i) {
      hands[i].heard(world->pressed()[i]);
      if (i < 3) sum += world->pressed()[i].force_N;
    }
    most_N = std::max(most_N, glm::length(sum));
    other_N = std::max(other_N, glm::length(world->pressed()[3].force_N));
  }
  REQUIRE(world->state() == MatterState::running);
  CHECK(most_N <= 0.3 * (1 + 1e-6));
  CHECK(most_N > 0.29);
  CHECK(other_N > 0.3);
  CHECK(other_N <= 0.9 * (1 + 1e-6));
}

TEST_CASE_FIXTURE(OnSoft, "presses that are not finite, or that pull, have no effect" * kPortable) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  const MatterScene scene = smallBlock();
  const auto world = make(scene, 0, nullptr, {}), alone = make(scene, 0, nullptr, {});
  const PressingHand good(topOf(scene), 0.006);
  std::uint32_t number = 0;
  const auto with = [&](auto change) {
    PressingHand hand = good;
    hand.press().hand = number++;
    SurfacePress press = hand.goTo(topOf(scene) - DVec3(0, 0.001, 0));
    change(press);
    return press;
  };
  const std::vector<SurfacePress> hostile{
      with([&](SurfacePress& press) { press.handTo_m.x = nan; }),
      with([&](SurfacePress& press) { press.place_m.y = nan; }),
      with([&](SurfacePress& press) { press.stiffness_N_m = infinite; }),
      with([&](SurfacePress& press) { press.normal = DVec3(0); }),
      with([&](SurfacePress& press) { press.normal.z = nan; }),
      with([&](SurfacePress& press) { press.stiffness_N_m = press.damping_N_s_m = 0; }),
      with([&](SurfacePress& press) { press.most_N = 0; }),
      with([&](SurfacePress& press) { press.handFrom_m.y = press.handTo_m.y = 1; })};
  for (int k = 0; k < 3; ++k) {
    world->press(hostile);
    world->step();
    alone->step();
    REQUIRE(world->pressed().size() == hostile.size());
    for (const PressReport& report : world->pressed()) {
      REQUIRE(report.force_N == DVec3(0));
      REQUIRE(report.impulse == DVec3(0));
    }
  }
  CHECK(sameBytes(*world, *alone));
  // Far from any surface, and with radius 0, the nearest position is pressed.
  for (const double radius : {0.0, 1e-6, 0.006}) {
    CAPTURE(radius);
    PressingHand far(topOf(scene) + DVec3(0.0003, 0.03, 0.0001), radius);
    const SurfacePress press = far.goTo(far.press().handTo_m - DVec3(0, 1e-4, 0));
    const auto pressed = make(scene, 0, nullptr, {});
    pressed->press({&press, 1});
    pressed->step();
    CHECK(pressed->pressed()[0].impulse.y > 1e-6);
    CHECK(missingShare(*pressed) <= 1e-5);
  }
  world->reset();
  CHECK(world->pressed().empty());
  world->press({});
  world->step();
  CHECK(world->pressed().empty());
}

TEST_CASE_FIXTURE(OnSoft, "a surface yields like a half-space, and like its mass if nothing holds it" * kFullOnGpu) {
  MatterScene scene = softBlock();
  scene.box_mm = {200, 200, 200};
  scene.fill_mm = {130, 100, 130};
  scene.pinned_mm = {DVec3(0), DVec3(200, 0.1, 200)};
  scene.poisson = 0.3;
  const auto deep = make(scene, 0, nullptr, {});
  // Mean displacement under a uniform pressure on a circle (Love 1929), minus that of the half-space below the block
  // (Boussinesq 1885).
  constexpr double kRadius_m = 0.0125;
  const double expected =
      16 * (1 - 0.3 * 0.3) / (3 * 9.8696 * 3e4 * kRadius_m) - (1 + 0.3) * (3 - 2 * 0.3) / (2 * 3.1416 * 3e4 * 0.1);
  checkTruth("how far a surface gives way to an even pressure (Love), mm/N",
             1e3 * deep->localCompliance_m_N({0.1, 0.1, 0.1}, kRadius_m, {0, -1, 0}), 1e3 * expected, 0.05);
  CHECK(sameBytes(*deep, *make(scene, 0, nullptr, {})));
  MatterScene free = softBlock();
  free.gravity_m_s2 = DVec3(0);
  const auto floating = make(free, 0, nullptr, {});
  const double byMass = 1 / (16 * 0.05 * 0.04 * 0.05 * 1000);
  CHECK(isWithin(0.03, floating->localCompliance_m_N({0.05, 0.04, 0.05}, 1, {0, -1, 0}), byMass));
  // On the floor it yields only slightly; the query does not change its motion.
  const auto standing = make(softBlock(), 0, nullptr, {}), unasked = make(softBlock(), 0, nullptr, {});
  run(*standing, 60);
  run(*unasked, 60);
  CHECK(standing->localCompliance_m_N({0.05, 0.04, 0.05}, 1, {0, -1, 0}) < 0.2 * byMass);
  run(*standing, 1);
  run(*unasked, 1);
  CHECK(sameBytes(*standing, *unasked));
  // A plate that is pressed together in its plane, and would buckle, yields the way that it is pushed.
  MatterScene plate = slowScene({60, 5, 60});
  plate.young_Pa = 2e4;
  const auto pressed = make(plate, 0, nullptr, {});
  std::vector<Vec3> together = pressed->positionsById();
  for (Vec3& velocity : together) velocity = Vec3(0.1f - velocity.x, 0, 0) / 0.02f;
  pressed->setVelocities(together);
  for (int k = 0; k < 10; ++k) {
    run(*pressed, 1);
    const double yields_m_N = pressed->localCompliance_m_N({0.1, 0.005, 0.1}, 0.01, {0, -1, 0});
    CHECK((yields_m_N > 0));
  }
}

TEST_CASE_FIXTURE(OnSoft,
                  "presses give the same results bit by bit again, with other threads and after a reset" * kPortable) {
  const int steps = onCpuOrGpu(30, 15);
  const MatterScene scene = smallBlock();
  const auto a = maker(1)(scene, 0, nullptr, {}), b = maker(3)(scene, 0, nullptr, {});
  const auto press = [&](MatterSimulation& world) {
    std::array hands{PressingHand(topOf(scene), 0.006), PressingHand(topOf(scene) + DVec3(0.005, 0, 0), 0.008)};
    for (int k = 0; k < steps; ++k) {
      std::array<SurfacePress, 2> presses;
      for (std::size_t i = 0; i < 2; ++i) presses[i] = hands[i].goTo(hands[i].press().handTo_m - DVec3(0, 5e-5, 1e-5));
      world.press({presses.data(), k % 7 == 6 ? std::size_t{1} : 2});
      world.step();
      for (std::size_t i = 0; i < world.pressed().size(); ++i) hands[i].heard(world.pressed()[i]);
    }
    CHECK(world.impulses().onTools.y > 1e-6);
    return hands[0].work_J();
  };
  const double work_J = press(*a);
  CHECK(press(*b) == work_J);
  CHECK(sameBytes(*a, *b));
  a->reset();
  CHECK(press(*a) == work_J);
  CHECK(sameBytes(*a, *b));
}

}  // namespace palpate::press_truths_test
