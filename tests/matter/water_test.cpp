// Water compared with hydrostatics, conservation laws, and itself.
#include <algorithm>

#include "tests/matter/matter_scenes.hpp"

namespace palpate::water_test {

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

}  // namespace palpate::water_test
