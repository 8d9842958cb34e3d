// Grains with friction.
#include <cmath>

#include "tests/matter/matter_truths.hpp"

namespace palpate {

namespace {

constexpr double kPi = 3.14159265358979323846;

// Angle of the surface to the horizontal after a bed has slid in a box that is tilted by 45 degrees.
double angleOfRepose_deg(double friction) {
  const MatterScene scene = sandbox({240, 240, 80}, {240, 80, 80}, friction, 45);
  MatterWorld world(scene, {.threads = 2});
  for (int k = 0; k < 20 && (k < 10 || world.observe().kinetic_J >= 1e-3); ++k) run(world, 100);
  CHECK(world.observe().kinetic_J < 1e-3);
  constexpr std::size_t kColumns = 24, kFromEnds = 5;
  std::array<double, kColumns> top{};
  for (const Vec3& place : world.positionsById()) {
    const auto column = std::min(static_cast<std::size_t>(place.x / 0.01f), kColumns - 1);
    top[column] = std::max(top[column], static_cast<double>(place.y));
  }
  double x = 0, y = 0, xx = 0, xy = 0, count = 0;
  for (std::size_t column = kFromEnds; column < kColumns - kFromEnds; ++column) {
    const double at = 0.01 * static_cast<double>(column);
    x += at, y += top[column], xx += at * at, xy += at * top[column], ++count;
  }
  return 45 - std::atan((count * xy - x * y) / (count * xx - x * x)) * 180 / kPi;
}

}  // namespace

TEST_CASE("a grain on a slope stays where friction holds it, and otherwise slides as Coulomb says") {
  for (const double friction : {0.0, 0.2, 0.4, 0.6, 0.9}) {
    CAPTURE(friction);
    checkSlope(onCpu(), friction);
  }
}

TEST_CASE(
    "a heap is the steeper the more its grains rub, at least as steep as one of them would stand, and comes to rest") {
  const double smooth = angleOfRepose_deg(0), little = angleOfRepose_deg(0.15), much = angleOfRepose_deg(0.4);
  CHECK(smooth < 8);
  CHECK(little > smooth + 5);
  CHECK(much > little + 5);
  CHECK(little > std::atan(0.15) * 180 / kPi);
  CHECK(much > std::atan(0.4) * 180 / kPi);
}

TEST_CASE("a column of sand falls to the side, and less far where it rubs more") {
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

TEST_CASE("a heap of sand does not creep, and keeps its momentum's account") {
  checkHeap(onCpu(), {100, 120, 80}, 800, 500);
}

TEST_CASE("a ball that is pushed into sand is pushed back") { checkBallInSand(onCpu()); }

}  // namespace palpate
