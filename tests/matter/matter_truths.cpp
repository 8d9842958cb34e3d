#include "tests/matter/matter_truths.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <random>

namespace palpate {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr DVec3 kTipping{80, 120, 80};  // of a tank of 20 spacings: a column that falls to the side, mm

std::unique_ptr<MatterSimulation> atRest(const MatterMaker& make, const MatterScene& scene, std::size_t tools = 0) {
  return make(scene, tools, placesAtRest(scene));
}

MatterScene tippingTank() {
  MatterScene scene = tank({20, 16, 8}, 12);
  scene.fill_mm = kTipping;
  return scene;
}

double displacedBy(double radius_m) { return 1000 * 4 * kPi / 3 * radius_m * radius_m * radius_m; }

MatterScene tankForBall(double radius_mm, double side_spacings, double filled_spacings) {
  MatterScene scene = tank({side_spacings, filled_spacings + 8, side_spacings}, filled_spacings);
  scene.tool = {.radius_mm = radius_mm, .mass_kg = displacedBy(radius_mm * 1e-3)};
  return scene;
}

// At rest around a ball that is there already.
std::vector<Vec3> placesAround(const DVec3& ball_m, const MatterScene& scene) {
  std::vector<Vec3> places = placesAtRest(scene);
  std::erase_if(places, [&](const Vec3& place) {
    return glm::length(DVec3(place) - ball_m) < (scene.tool.radius_mm + 0.3 * scene.spacing_mm) * 1e-3;
  });
  return places;
}

}  // namespace

void checkWaterAtRest(const MatterMaker& make, int settling, int steps) {
  const MatterScene scene = tank({10, 20, 10}, 16);
  const auto world = atRest(make, scene);
  double mostCompression = 0;
  for (int k = 0; k < settling; ++k) {
    world->step();
    mostCompression = std::max(mostCompression, world->totals().maxCompression);
  }
  CHECK(mostCompression <= 0.01);
  CHECK(mostCompression > 0.001);
  // Means, as waves go on.
  constexpr std::array kHeights_m{0.03, 0.05, 0.07, 0.09};
  std::array<double, kHeights_m.size()> pressures{};
  const DVec3 before = world->impulses().onWalls;
  for (int k = 0; k < steps; ++k) {
    run(*world, 1);
    for (std::size_t h = 0; h < kHeights_m.size(); ++h)
      pressures[h] += world->pressureAt({0.05, kHeights_m[h], 0.05}) / steps;
  }
  for (std::size_t h = 0; h < kHeights_m.size(); ++h) {
    const double expected = scene.density_kg_m3 * kGravity_m_s2 * (0.16 - kHeights_m[h]);
    CAPTURE(kHeights_m[h]);
    CHECK(isWithin(0.02, pressures[h], expected));
  }
  const double onFloor_N = -(world->impulses().onWalls - before).y / (steps * kMatterStep_s);
  CHECK(isWithin(0.01, onFloor_N, massOf(*world) * kGravity_m_s2));
}

void checkMomentumIsAccountedFor(const MatterMaker& make, int steps) {
  const auto world = atRest(make, tippingTank());
  for (int k = 0; k < steps; ++k) {
    run(*world, 1);
    REQUIRE(missingMomentum(*world) <= 1e-5);
  }
  CHECK(std::abs(world->impulses().onWalls.y) > 0.1);
}

void checkMomentumStays(const MatterMaker& make, int steps) {
  MatterScene scene = tank({12, 12, 12}, 12);
  scene.gravity_m_s2 = DVec3(0);
  scene.periodic = {true, true, true};
  scene.substeps = 4;
  const auto world = atRest(make, scene);
  DVec3 before(0);
  std::vector<Vec3> velocities(world->particles());
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    velocities[i] = Vec3(std::sin(0.7 * i), std::cos(1.3 * i), 0.5);
    before += world->plan().mass_kg * DVec3(velocities[i]);
  }
  world->setVelocities(velocities);
  run(*world, steps);
  CHECK(glm::length(world->totals().momentum - before) <= 1e-5 * glm::length(before));
}

void checkWallsHold(const MatterMaker& make, int steps) {
  const MatterScene scene = tippingTank();
  const auto world = atRest(make, scene);
  for (int k = 0; k < steps; ++k) {
    run(*world, 1);
    for (const Vec3& place : world->positionsById())
      for (int axis = 0; axis < 3; ++axis) {
        REQUIRE(place[axis] >= 0.005f);
        REQUIRE(place[axis] <= static_cast<float>(scene.box_mm[axis] * 1e-3 - 0.005) * 1.000001f);
      }
  }
}

void checkSameBytes(const MatterMaker& one, const MatterMaker& other, Matter matter, int steps) {
  MatterScene scene = tippingTank();
  scene.matter = matter;
  scene.tool = {.radius_mm = 20, .mass_kg = 0.1};
  const auto a = atRest(one, scene, 1), b = atRest(other, scene, 1);
  const auto runBoth = [&](MatterSimulation& world) {
    HandPose hand{.place_m = {0.08, 0.14, 0.04}};
    for (int k = 0; k < steps; ++k) {
      hand.place_m.y -= 4e-4;
      world.step({&hand, 1});
    }
    REQUIRE(world.state() == MatterState::running);
  };
  const auto checkAlike = [&] {
    CHECK(sameBytes(*a, *b));
    CHECK(a->totals().kinetic_J == b->totals().kinetic_J);
    CHECK(a->impulses().onWalls == b->impulses().onWalls);
    CHECK(a->answers()[0].force_N == b->answers()[0].force_N);
    CHECK(a->answers()[0].torque_Nm == b->answers()[0].torque_Nm);
  };
  runBoth(*a);
  runBoth(*b);
  checkAlike();
  a->reset();
  runBoth(*a);
  checkAlike();
}

void checkBuoyancy(const MatterMaker& make, double radius_m, int settling, int steps) {
  const MatterScene scene = tankForBall(radius_m * 1e3, 12, 12);
  const HandPose hand{.place_m = {0.06, 0.06, 0.06}};
  const auto world = make(scene, 1, placesAround(hand.place_m, scene));
  DVec3 reaction(0), force(0);
  for (int k = 0; k < settling + steps; ++k) {
    world->step({&hand, 1});
    if (k < settling) continue;
    reaction += world->answers()[0].reaction_N / double(steps);
    force += world->answers()[0].force_N / double(steps);
  }
  REQUIRE(world->state() == MatterState::running);
  const double expected = displacedBy(radius_m) * kGravity_m_s2;
  CHECK(isWithin(0.03, reaction.y, expected));
  CHECK(isWithin(0.03, force.y, expected));
  CHECK(std::hypot(reaction.x, reaction.z) <= 0.03 * expected);
}

void checkRandomHands(const MatterMaker& make, int hands, int steps) {
  const MatterScene scene = tankForBall(30, 14, 9);
  std::mt19937 random(7);
  std::normal_distribution<double> push;
  for (int each = 0; each < hands; ++each) {
    const auto world = atRest(make, scene, 1);
    HandPose hand{.place_m = {0.07, 0.14, 0.07}};
    DVec3 speed(0);
    double least_J = 0;
    for (int k = 0; k < steps; ++k) {
      speed = 0.98 * speed - DVec3(0, 5e-3, 0);
      for (int axis = 0; axis < 3; ++axis) speed[axis] += 0.05 * push(random);
      hand.place_m = glm::clamp(hand.place_m + kMatterStep_s * speed, DVec3(0.03), DVec3(0.11, 0.14, 0.11));
      world->step({&hand, 1});
      least_J = std::min(least_J, world->portEnergy_J(0));
    }
    REQUIRE(world->state() == MatterState::running);
    CHECK(least_J >= -1e-3);
    CHECK(world->portEnergy_J(0) > 1e-3);
  }
}

void checkReactions(const MatterMaker& make) {
  const MatterScene scene = tankForBall(30, 14, 9);
  const auto world = atRest(make, scene, 2);
  std::array<HandPose, 2> hands{HandPose{.place_m = {0.035, 0.14, 0.07}}, HandPose{.place_m = {0.105, 0.14, 0.07}}};
  DVec3 reactions(0);
  for (int k = 0; k < 300; ++k) {
    hands[0].place_m.y -= 3e-4;
    hands[1].place_m.y -= 2e-4;
    world->step(hands);
    reactions += kMatterStep_s * (world->answers()[0].reaction_N + world->answers()[1].reaction_N);
  }
  REQUIRE(world->state() == MatterState::running);
  const MatterImpulses& given = world->impulses();
  CHECK(glm::length(given.onTools) > 0.01);
  CHECK(glm::length(given.onTools - reactions) <= 1e-9 * glm::length(reactions));
  CHECK(missingMomentum(*world) <= 1e-5);
}

MatterScene sandbox(const DVec3& box_mm, const DVec3& fill_mm, double friction, double tilt_deg) {
  const double tilt = tilt_deg * kPi / 180;
  return {.matter = Matter::sand,
          .box_mm = box_mm,
          .fill_mm = fill_mm,
          .spacing_mm = 10,
          .density_kg_m3 = 1600,
          .friction = friction,
          .gravity_m_s2 = kGravity_m_s2 * DVec3(std::sin(tilt), -std::cos(tilt), 0),
          .periodic = {false, false, true}};
}

void checkSlope(const MatterMaker& make, double friction) {
  constexpr double kTilt_deg = 30;
  const double down = kGravity_m_s2 * std::sin(kTilt_deg * kPi / 180),
               across = kGravity_m_s2 * std::cos(kTilt_deg * kPi / 180);
  const MatterScene scene = sandbox({1000, 100, 80}, {10, 10, 10}, friction, kTilt_deg);
  const auto world = make(scene, 0, {Vec3(0.1f, 0.005f, 0.04f)});
  run(*world, 100);
  const double before = world->velocitiesById()[0].x;
  run(*world, 200);
  const double acceleration = (world->velocitiesById()[0].x - before) / 0.2;
  if (friction > down / across) {
    run(*world, 500);  // it swings on what friction gives in before it stands
    const float place = world->positionsById()[0].x;
    run(*world, 200);
    CHECK(std::abs(world->velocitiesById()[0].x) < 1e-5);
    CHECK(std::abs(world->positionsById()[0].x - place) < 1e-6);
  } else {
    CHECK(isWithin(0.02, acceleration, down - friction * across));
  }
}

void checkHeap(const MatterMaker& make, int falling, int resting) {
  const auto world = atRest(make, sandbox({240, 200, 80}, {100, 120, 80}, 0.5, 0));
  run(*world, falling);
  CHECK(missingMomentum(*world) <= 1e-5);
  const std::vector<Vec3> before = world->positionsById();
  run(*world, resting);
  const std::vector<Vec3> after = world->positionsById();
  double farthest = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    farthest = std::max(farthest, double(glm::length(after[i] - before[i])));
  CHECK(farthest < 1e-3);
}

void checkBallInSand(const MatterMaker& make) {
  MatterScene scene = sandbox({140, 200, 140}, {140, 80, 140}, 0.5, 0);
  scene.tool = {.radius_mm = 30, .mass_kg = 0.2};
  const auto world = atRest(make, scene, 1);
  HandPose hand{.place_m = {0.07, 0.15, 0.07}};
  for (int k = 0; k < 500; ++k) {
    hand.place_m.y -= 1e-4;
    world->step({&hand, 1});
  }
  REQUIRE(world->state() == MatterState::running);
  CHECK(world->answers()[0].reaction_N.y > 0.5);
  CHECK(world->portEnergy_J(0) > 0);
  CHECK(missingMomentum(*world) <= 1e-5);
}

void checkFewParticles(const MatterMaker& make) {
  for (const Matter matter : {Matter::water, Matter::sand}) {
    const MatterScene scene{.matter = matter, .fill_mm = DVec3(0)};
    const auto empty = make(scene, 0, {});
    run(*empty, 20);
    CHECK(empty->observe().particles == 0);
    CHECK(empty->observe().kinetic_J == 0);
    CHECK(empty->pressureAt(DVec3(0.05)) == 0);
    const auto single = make(scene, 0, {Vec3(0.05f, 0.08f, 0.05f)});
    run(*single, 100);
    const double fallen = 0.08 - static_cast<double>(single->positionsById()[0].y);
    CHECK(isWithin(0.02, fallen, 0.5 * kGravity_m_s2 * 0.01));
    run(*single, 400);
    CHECK(std::abs(single->velocitiesById()[0].y) < 0.01);
    CHECK(std::abs(single->positionsById()[0].y - 0.0025f) < 5e-4f);
  }
}

void checkDivergence(const MatterMaker& make) {
  const MatterScene scene{.tool = {.radius_mm = 20, .mass_kg = 0.1}};
  for (const float velocity : {1e6f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    CAPTURE(velocity);
    const auto world = atRest(make, scene, 1);
    const HandPose hand{.place_m = {0.05, 0.06, 0.05}};
    world->step({&hand, 1});
    std::vector<Vec3> velocities = world->velocitiesById();
    for (Vec3& v : velocities) v.x = velocity;
    world->setVelocities(velocities);
    world->step({&hand, 1});
    CHECK(world->state() == MatterState::diverged);
    const std::vector<Vec3> before = world->positionsById();
    world->step({&hand, 1});
    CHECK(world->answers()[0].force_N == DVec3(0));
    CHECK(world->answers()[0].reaction_N == DVec3(0));
    CHECK(std::memcmp(world->positionsById().data(), before.data(), before.size() * sizeof(Vec3)) == 0);
    world->reset();
    CHECK(world->state() == MatterState::running);
    const auto fresh = atRest(make, scene, 1);
    for (int k = 0; k < 5; ++k) {
      world->step({&hand, 1});
      fresh->step({&hand, 1});
    }
    CHECK(sameBytes(*world, *fresh));
  }
}

void checkJumpingHand(const MatterMaker& make, int steps) {
  const MatterScene scene{.tool = {.radius_mm = 20, .mass_kg = 0.1}};
  const auto world = atRest(make, scene, 1);
  for (int k = 0; k < steps; ++k) {
    const double far = k % 20 == 10 ? 1e3 : 0.08;
    const HandPose hand{.place_m = {0.05, far, 0.05}};
    world->step({&hand, 1});
    REQUIRE(isFinite(world->answers()[0].force_N));
    REQUIRE(isFinite(world->answers()[0].reaction_N));
  }
}

}  // namespace palpate
