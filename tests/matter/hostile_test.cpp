// Extreme states.
#include "tests/matter/matter_truths.hpp"

namespace palpate::hostile_test {

TEST_CASE("no particle and a single particle are simulated") { checkFewParticles(onCpu()); }

TEST_CASE("coincident particles are simulated, or give the state crowded") {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const std::size_t count : {std::size_t{300}, std::size_t{3000}}) {
      MatterWorld world({.matter = matter}, {.threads = 2}, std::vector<Vec3>(count, Vec3(0.05f)));
      for (int k = 0; k < 20; ++k) world.step();
      CHECK((world.state() == MatterState::crowded) == (count > kMaxNeighbours));
      for (const Vec3& place : world.positionsById()) REQUIRE(isFinite(place));
    }
}

TEST_CASE("a diverging simulation reports it, has no force from then on, and can be reset") {
  checkDivergence(onCpu());
}

TEST_CASE("a hand that jumps across the box gets a bounded, finite force or ends the simulation") {
  checkJumpingHand(onCpu(), 200);
}

TEST_CASE("the shortest and the longest allowed substeps work") {
  MatterScene scene = tank({8, 12, 8}, 8);
  scene.substeps = 60;
  MatterWorld fine(scene, {.threads = 2});
  run(fine, 100);
  CHECK(fine.observe().maxCompression < 1e-3);
  scene.substeps = 0;
  scene.gravity_m_s2 = DVec3(0);
  CHECK(planOf(scene).substeps == 1);
  MatterWorld coarse(scene, {.threads = 2});
  run(coarse, 500);
  CHECK(coarse.observe().kinetic_J < 1e-6);
}

}  // namespace palpate::hostile_test
