// States that nobody wants to simulate.
#include <cmath>
#include <limits>

#include "tests/matter/matter_scenes.hpp"

namespace palpate {

TEST_CASE("no particle at all, and a single one, are simulated as well") {
  for (const Matter matter : {Matter::water, Matter::sand}) {
    MatterScene scene{.matter = matter, .fill_mm = DVec3(0)};
    MatterWorld empty(scene);
    run(empty, 20);
    CHECK(empty.observe().particles == 0);
    CHECK(empty.observe().kinetic_J == 0);
    CHECK(empty.pressureAt(DVec3(0.05)) == 0);
    MatterWorld single(scene, {}, {Vec3(0.05f, 0.08f, 0.05f)});
    run(single, 100);
    const double fallen = 0.08 - static_cast<double>(single.positionsById()[0].y);
    CHECK(isWithin(0.02, fallen, 0.5 * kGravity_m_s2 * 0.01));
    run(single, 400);
    CHECK(std::abs(single.velocitiesById()[0].y) < 0.01);
    CHECK(std::abs(single.positionsById()[0].y - 0.0025f) < 5e-4f);
  }
}

TEST_CASE("all particles on one place are simulated, or refused as a state with a name") {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const std::size_t count : {std::size_t{300}, std::size_t{3000}}) {
      MatterWorld world({.matter = matter}, {.threads = 2}, std::vector<Vec3>(count, Vec3(0.05f)));
      for (int k = 0; k < 20; ++k) world.step();
      CHECK((world.state() == MatterState::crowded) == (count > kMostNeighbours));
      for (const Vec3& place : world.positionsById()) REQUIRE(isFinite(place));
    }
}

TEST_CASE("a simulation that diverges says so, has no force from then on, and can be begun again") {
  MatterScene scene{.tool = {.radius_mm = 20, .mass_kg = 0.1}};
  for (const float velocity : {1e6f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    MatterWorld world(scene, {.threads = 2, .tools = 1});
    const HandPose hand{.place_m = {0.05, 0.06, 0.05}};
    world.step({&hand, 1});
    for (Vec3& v : world.particles().velocities()) v.x = velocity;
    world.step({&hand, 1});
    CHECK(world.state() == MatterState::diverged);
    const std::vector<Vec3> before = world.positionsById();
    world.step({&hand, 1});
    CHECK(world.answers()[0].force_N == DVec3(0));
    CHECK(world.answers()[0].reaction_N == DVec3(0));
    CHECK(std::memcmp(world.positionsById().data(), before.data(), before.size() * sizeof(Vec3)) == 0);
    world.reset();
    CHECK(world.state() == MatterState::running);
    MatterWorld fresh(scene, {.threads = 2, .tools = 1});
    for (int k = 0; k < 5; ++k) {
      world.step({&hand, 1});
      fresh.step({&hand, 1});
    }
    CHECK(sameBytes(world, fresh));
  }
}

TEST_CASE("a hand that jumps across the box gives a bounded force or ends the simulation, never what is no number") {
  MatterScene scene{.tool = {.radius_mm = 20, .mass_kg = 0.1}};
  MatterWorld world(scene, {.threads = 2, .tools = 1});
  for (int k = 0; k < 200; ++k) {
    const double far = k % 20 == 10 ? 1e3 : 0.08;
    const HandPose hand{.place_m = {0.05, far, 0.05}};
    world.step({&hand, 1});
    REQUIRE(isFinite(world.answers()[0].force_N));
    REQUIRE(isFinite(world.answers()[0].reaction_N));
  }
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

}  // namespace palpate
