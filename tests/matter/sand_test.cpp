// Grains with friction.

#include "tests/matter/matter_scenes.hpp"

namespace palpate::sand_test {

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

}  // namespace palpate::sand_test
