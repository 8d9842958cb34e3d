// Water against hydrostatics, conservation, and itself.
#include <algorithm>
#include <cmath>

#include "tests/matter/matter_scenes.hpp"

namespace palpate {

TEST_CASE(
    "water at rest presses as deep as it is, weighs on its floor what it weighs, and is compressed by 1 % at most") {
  const MatterScene scene = tank({10, 20, 10}, 16);
  MatterWorld world(scene, {.threads = 2});
  double mostCompression = 0;
  for (int k = 0; k < 600; ++k) {
    world.step();
    mostCompression = std::max(mostCompression, world.observe().maxCompression);
  }
  CHECK(mostCompression <= 0.01);
  CHECK(mostCompression > 0.001);
  // Means over two tenths of a second: waves go on.
  constexpr int kSteps = 200;
  constexpr std::array kHeights_m{0.03, 0.05, 0.07, 0.09};
  std::array<double, kHeights_m.size()> pressures{};
  const DVec3 before = world.impulses().onWalls;
  for (int k = 0; k < kSteps; ++k) {
    run(world, 1);
    for (std::size_t h = 0; h < kHeights_m.size(); ++h)
      pressures[h] += world.pressureAt({0.05, kHeights_m[h], 0.05}) / kSteps;
  }
  for (std::size_t h = 0; h < kHeights_m.size(); ++h) {
    const double expected = scene.density_kg_m3 * kGravity_m_s2 * (0.16 - kHeights_m[h]);
    CAPTURE(kHeights_m[h]);
    CHECK(isWithin(0.02, pressures[h], expected));
  }
  const double onFloor_N = -(world.impulses().onWalls - before).y / (kSteps * kMatterStep_s);
  CHECK(isWithin(0.01, onFloor_N, massOf(world) * kGravity_m_s2));
}

TEST_CASE("momentum is what gravity gave less what the walls took") {
  MatterScene scene = tank({20, 16, 8}, 12);
  scene.fill_mm.x = 80;
  MatterWorld world(scene, {.threads = 2});
  for (int k = 0; k < 400; ++k) {
    run(world, 1);
    const MatterImpulses& given = world.impulses();
    const DVec3 missing = world.observe().momentum - (given.gravity - given.onWalls);
    REQUIRE(glm::length(missing) <= 1e-5 * glm::length(given.gravity));
  }
  CHECK(std::abs(world.impulses().onWalls.y) > 0.1);
}

TEST_CASE("without gravity and walls momentum stays what it was") {
  MatterScene scene = tank({12, 12, 12}, 12);
  scene.gravity_m_s2 = DVec3(0);
  scene.periodic = {true, true, true};
  scene.substeps = 4;
  MatterWorld world(scene, {.threads = 2});
  DVec3 before(0);
  const std::span<Vec3> velocities = world.particles().velocities();
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    velocities[i] = Vec3(std::sin(0.7 * i), std::cos(1.3 * i), 0.5);
    before += world.plan().mass_kg * DVec3(velocities[i]);
  }
  run(world, 300);
  CHECK(glm::length(world.observe().momentum - before) <= 1e-5 * glm::length(before));
}

TEST_CASE("the same bytes with one thread and with three") {
  MatterScene scene = tank({20, 16, 8}, 12);
  scene.fill_mm.x = 80;
  MatterWorld one(scene, {.threads = 1}), three(scene, {.threads = 3});
  run(one, 150);
  run(three, 150);
  CHECK(sameBytes(one, three));
  CHECK(one.observe().kinetic_J == three.observe().kinetic_J);
  CHECK(one.impulses().onWalls == three.impulses().onWalls);
  one.reset();
  run(one, 150);
  CHECK(sameBytes(one, three));
}

TEST_CASE("water that stands in a tank comes to rest, and does not grow") {
  const MatterScene scene = tank({8, 16, 8}, 12, 20);
  MatterWorld world(scene, {.threads = 2});
  run(world, 500);
  const double early_J = world.observe().kinetic_J;
  run(world, 4500);
  const MatterObservation late = world.observe();
  CHECK(late.kinetic_J <= early_J);
  // A thousandth of what it would take to lift all of it by its own height.
  CHECK(late.kinetic_J <= 1e-3 * massOf(world) * kGravity_m_s2 * 0.24);
  float top = 0;
  for (const Vec3& place : world.positionsById()) top = std::max(top, place.y);
  CHECK(isWithin(0.03, top + 0.01, 0.24));
}

TEST_CASE("no particle is ever beyond a wall") {
  MatterScene scene = tank({20, 16, 8}, 12);
  scene.fill_mm.x = 80;
  MatterWorld world(scene, {.threads = 2});
  for (int k = 0; k < 300; ++k) {
    run(world, 1);
    for (const Vec3& place : world.particles().positions())
      for (int axis = 0; axis < 3; ++axis) {
        REQUIRE(place[axis] >= 0.005f);
        REQUIRE(place[axis] <= static_cast<float>(scene.box_mm[axis] * 1e-3 - 0.005) * 1.000001f);
      }
  }
}

}  // namespace palpate
