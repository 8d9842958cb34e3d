// Extreme states.
#include "tests/matter/matter_truths.hpp"

namespace palpate::hostile_test {

TEST_CASE("no particle at all, and a single one, are simulated as well") { checkFewParticles(onCpu()); }

TEST_CASE("all particles on one place are simulated, or refused as a state with a name") {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const std::size_t count : {std::size_t{300}, std::size_t{3000}}) {
      MatterWorld world({.matter = matter}, {.threads = 2}, std::vector<Vec3>(count, Vec3(0.05f)));
      for (int k = 0; k < 20; ++k) world.step();
      CHECK((world.state() == MatterState::crowded) == (count > kMaxNeighbours));
      for (const Vec3& place : world.positionsById()) REQUIRE(isFinite(place));
    }
}

TEST_CASE("a simulation that diverges says so, has no force from then on, and can be begun again") {
  checkDivergence(onCpu());
}

TEST_CASE("a hand that jumps across the box gives a bounded force or ends the simulation, never what is no number") {
  checkJumpingHand(onCpu(), 200);
}

TEST_CASE("the shortest and the longest substeps that are taken work") {
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
