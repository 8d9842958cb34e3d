// Grains with friction.
#include <cmath>

#include "tests/labels.hpp"
#include "tests/matter/matter_truths.hpp"

namespace palpate::sand_test {

TEST_CASE("a grain on a slope sticks or slides by Coulomb's law") {
  for (const double friction : {0.0, 0.2, 0.4, 0.6, 0.9}) {
    CAPTURE(friction);
    checkSlope(onCpu(), friction);
  }
}

TEST_CASE("a sliding bed of sand comes to rest at the angle of repose of grains that do not rotate" * kMoreInFull) {
  for (const double friction : byTier<std::vector<double>>({0.3}, {0.1, 0.2, 0.3, 0.4}))
    checkAngleOfRepose(onCpu(), friction, 70, 5);
}

TEST_CASE("a column of sand collapses sideways, and less far with more friction") {
  std::array<double, 2> fronts{};
  for (const double friction : {0.2, 0.6}) {
    MatterScene scene = sandbox({400, 160, 80}, {80, 120, 80}, friction, 0);
    MatterWorld world(scene, {.threads = 2});
    run(world, 500);
    fronts[friction > 0.4 ? 1 : 0] = world.observe().front_m;
    CHECK(world.observe().front_m > 0.1);
  }
  CHECK(fronts[0] > fronts[1] + 0.02);
}

TEST_CASE("a heap of sand does not creep, and its momentum balances") { checkHeap(onCpu(), {100, 120, 80}, 800, 500); }

TEST_CASE("sand pushes back a ball that is pushed into it") { checkBallInSand(onCpu()); }

}  // namespace palpate::sand_test
