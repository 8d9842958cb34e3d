// Water against hydrostatics, conservation, and itself.
#include <algorithm>
#include <cmath>

#include "tests/matter/matter_truths.hpp"

namespace palpate::water_test {

TEST_CASE(
    "water at rest presses as deep as it is, weighs on its floor what it weighs, and is compressed by 1 % at most") {
  checkWaterAtRest(onCpu(), 600, 200);
}

TEST_CASE("momentum is what gravity gave less what the walls took") { checkMomentumIsAccountedFor(onCpu(), 400); }

TEST_CASE("without gravity and walls momentum stays what it was") { checkMomentumStays(onCpu(), 300); }

TEST_CASE("the same bytes with one thread and with three") {
  for (const Matter matter : {Matter::water, Matter::sand}) checkSameBytes(onCpu(1), onCpu(3), matter, 150);
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

TEST_CASE("no particle is ever beyond a wall") { checkWallsHold(onCpu(), 300); }

TEST_CASE("cohesion makes a block in the air rounder, and gives it neither a push nor a turn") {
  checkCohesion(onCpu(), 300, 1.6);
}

}  // namespace palpate::water_test
