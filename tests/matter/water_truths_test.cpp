// Water, and extreme states of matter, on each back end.
#include <algorithm>
#include <array>
#include <limits>

#include "tests/labels.hpp"
#include "tests/matter/on_matter.hpp"

namespace palpate::water_truths_test {

namespace {

constexpr DVec3 kTipping{80, 120, 80};  // in a tank of 20 spacings: a column that falls sideways, mm

MatterScene tippingTank() {
  MatterScene scene = tank({20, 16, 8}, 12);
  scene.fill_mm = kTipping;
  return scene;
}

}  // namespace

TEST_CASE_FIXTURE(OnMatter,
                  "water at rest has the pressure of its depth, its weight on the floor, and at most 1 % compression" *
                      kFullOnGpu) {
  const int settling = onCpuOrGpu(600, 200), steps = onCpuOrGpu(200, 80);
  const MatterScene scene = tank({10, 20, 10}, 16);
  const auto world = atRest(make, scene);
  double mostCompression = 0;
  for (int k = 0; k < settling; ++k) {
    world->step();
    mostCompression = std::max(mostCompression, world->totals().maxCompression);
  }
  checkAtMost("compression of water at rest, %", 100 * mostCompression, 1);
  CHECK(mostCompression > 0.001);
  // Means, because waves persist.
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
    checkTruth(fmt::format("pressure {:.0f} mm below the surface, Pa", 160 - 1e3 * kHeights_m[h]), pressures[h],
               expected, 0.02);
  }
  const double onFloor_N = -(world->impulses().onWalls - before).y / (steps * kMatterStep_s);
  checkTruth("weight on the floor, N", onFloor_N, massOf(*world) * kGravity_m_s2, 0.01);
}

TEST_CASE_FIXTURE(OnMatter, "momentum balances gravity and walls" * kMoreInFull) {
  const int steps = onCpuOrGpu(400, byTier(50, 150));
  const auto world = atRest(make, tippingTank());
  double missing = 0;
  for (int k = 0; k < steps; ++k) {
    run(*world, 1);
    missing = std::max(missing, missingMomentum(*world));
  }
  checkAtMost("momentum that nobody gave, of what gravity gave", missing, 1e-5);
  CHECK(std::abs(world->impulses().onWalls.y) > 0.1);
}

TEST_CASE_FIXTURE(OnMatter, "momentum is conserved without gravity and walls" * kMoreInFull) {
  const int steps = onCpuOrGpu(300, byTier(10, 30));
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
  checkAtMost("change of momentum without gravity and walls, share",
              glm::length(world->totals().momentum - before) / glm::length(before), 1e-5);
}

TEST_CASE_FIXTURE(OnMatter, "no particle passes a wall") {
  const int steps = onCpuOrGpu(300, 100);
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

TEST_CASE_FIXTURE(OnMatter,
                  "water and sand give the same results bit by bit again, and with other threads" * kMoreInFull) {
  const int steps = onCpuOrGpu(150, byTier(15, 60));
  for (const Matter matter : {Matter::water, Matter::sand}) {
    MatterScene scene = tippingTank();
    scene.matter = matter;
    scene.tool = {.radius_mm = 20, .mass_kg = 0.1};
    const auto a = atRest(maker(1), scene, 1), b = atRest(maker(3), scene, 1);
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
}

TEST_CASE_FIXTURE(OnMatter, "no particle and a single particle are simulated" * kFullOnGpu * kPortable) {
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

TEST_CASE_FIXTURE(OnMatter, "coincident particles are simulated, or give the state crowded" * kPortable) {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const std::size_t count : onCpuOrGpu<std::vector<std::size_t>>({300, 3000}, {60, 1000, 5000})) {
      const auto world = make({.matter = matter}, 0, std::vector<Vec3>(count, Vec3(0.05f)));
      for (int k = 0; k < onCpuOrGpu(20, 5); ++k) world->step();
      CHECK((world->state() == MatterState::crowded) == (count > onCpuOrGpu<std::size_t>(kMaxNeighbours, 129)));
      for (const Vec3& place : world->positionsById()) REQUIRE(isFinite(place));
    }
}

TEST_CASE_FIXTURE(OnMatter,
                  "a diverging simulation reports it, has no force from then on, and can be reset" * kPortable) {
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

TEST_CASE_FIXTURE(OnMatter,
                  "a hand that jumps across the box gets a bounded, finite force or ends the simulation" * kPortable) {
  const int steps = onCpuOrGpu(200, 60);
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

namespace {

struct Spread {
  DVec3 middle{0}, width{0}, spin{0};  // width: RMS about the middle; spin: mean of arms times velocities
};

Spread spreadOf(const MatterSimulation& world) {
  const std::vector<Vec3> places = world.positionsById(), velocities = world.velocitiesById();
  const double each = 1 / static_cast<double>(places.size());
  Spread spread;
  for (const Vec3& place : places) spread.middle += each * DVec3(place);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const DVec3 arm = DVec3(places[i]) - spread.middle;
    spread.width += each * arm * arm;
    spread.spin += each * glm::cross(arm, DVec3(velocities[i]));
  }
  spread.width = glm::sqrt(spread.width);
  return spread;
}

}  // namespace

TEST_CASE_FIXTURE(OnMatter,
                  "cohesion makes a floating block rounder, without linear or angular momentum" * kFullOnGpu) {
  const int steps = onCpuOrGpu(300, 60);
  const double ratio = onCpuOrGpu(1.6, 1.95);  // of length to width at the end, from 2
  MatterScene slippery = floatingBlock(0.0728);
  slippery.viscosity_Pa_s = 0;  // without viscosity, which reduces spin because it damps all relative velocities
  const auto block = atRest(make, floatingBlock(0.0728)), without = atRest(make, floatingBlock(0)),
             turning = atRest(make, slippery);
  constexpr double kTurn_rad_s = 2;
  const Spread begin = spreadOf(*block);
  std::vector<Vec3> velocities;
  for (const Vec3& place : turning->positionsById())
    velocities.emplace_back(glm::cross(DVec3(kTurn_rad_s, 0, 0), DVec3(place) - begin.middle));
  turning->setVelocities(velocities);
  const DVec3 spin = spreadOf(*turning).spin;
  for (MatterSimulation* world : {block.get(), without.get(), turning.get()}) run(*world, steps);
  const Spread is = spreadOf(*block);
  checkAtMost(fmt::format("length over width of a block after {} ms of cohesion, 2 at first", steps),
              is.width.x / std::max(is.width.y, is.width.z), ratio);
  CHECK(is.width.x / std::max(is.width.y, is.width.z) > 0.9);
  CHECK(glm::length(is.middle - begin.middle) < 1e-7);
  // A substep moves particles by their changed velocities, which preserves spin except for an error of the step size.
  CHECK(glm::length(spreadOf(*turning).spin - spin) <= 1e-2 * glm::length(spin));
  CHECK(block->impulses().onWalls == DVec3(0));
  double farthest = 0;
  for (const Vec3& place : block->positionsById()) farthest = std::max(farthest, glm::length(DVec3(place) - is.middle));
  CHECK(farthest < 0.0102);  // the distance of a corner at the beginning
  for (int axis = 0; axis < 3; ++axis) CHECK(isWithin(1e-3, spreadOf(*without).width[axis], begin.width[axis]));
}

}  // namespace palpate::water_truths_test
