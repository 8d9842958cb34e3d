// Water compared with hydrostatics, conservation laws, and itself.
#include <algorithm>
#include <cmath>

#include "tests/matter/matter_truths.hpp"

namespace palpate::water_test {

TEST_CASE("water at rest has the pressure of its depth, its weight on the floor, and at most 1 % compression") {
  checkWaterAtRest(onCpu(), 600, 200);
}

TEST_CASE("momentum balances gravity and walls") { checkMomentumIsAccountedFor(onCpu(), 400); }

TEST_CASE("momentum is conserved without gravity and walls") { checkMomentumStays(onCpu(), 300); }

TEST_CASE("water gives the same results bit by bit with one thread and with three") {
  for (const Matter matter : {Matter::water, Matter::sand}) checkSameBytes(onCpu(1), onCpu(3), matter, 150);
}

TEST_CASE("water in a tank comes to rest and does not expand") {
  const MatterScene scene = tank({8, 16, 8}, 12, 20);
  MatterWorld world(scene, {.threads = 2});
  run(world, 500);
  const double early_J = world.observe().kinetic_J;
  run(world, 4500);
  const MatterObservation late = world.observe();
  CHECK(late.kinetic_J <= early_J);
  // A thousandth of the energy to lift all of it by its own height.
  CHECK(late.kinetic_J <= 1e-3 * massOf(world) * kGravity_m_s2 * 0.24);
  float top = 0;
  for (const Vec3& place : world.positionsById()) top = std::max(top, place.y);
  CHECK(isWithin(0.03, top + 0.01, 0.24));
}

TEST_CASE("a tank filled to a fraction of a spacing has the requested height") {
  // A column in a tank of 80 by 80 mm: the mean height of its particles is half of its height.
  for (const double fill_mm : {45.0, 32.0}) {
    CAPTURE(fill_mm);
    const MatterScene scene{.box_mm = {80, 80, 80}, .fill_mm = {80, fill_mm, 80}, .spacing_mm = 10};
    const auto world = onCpu()(scene, 0, placesAtRest(scene));
    run(*world, 400);
    double height_mm = 0;
    for (const Vec3& place : world->positionsById())
      height_mm += 2e3 * static_cast<double>(place.y) / static_cast<double>(world->particles());
    CHECK(isWithin(0.03, height_mm, fill_mm));
    CHECK(isWithin(1e-6, massOf(*world), 0.08 * 0.08 * 1e-3 * fill_mm * 1000));
  }
}

TEST_CASE("no particle passes a wall") { checkWallsHold(onCpu(), 300); }

TEST_CASE("cohesion makes a floating block rounder, without linear or angular momentum") {
  checkCohesion(onCpu(), 300, 1.6);
}

}  // namespace palpate::water_test
