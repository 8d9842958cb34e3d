// Grains with friction.
#include <cmath>

#include "tests/matter/matter_scenes.hpp"

namespace palpate {

namespace {

constexpr double kPi = 3.14159265358979323846;

MatterScene sandbox(const DVec3& box_mm, const DVec3& fill_mm, double friction, double tilt_deg) {
  const double tilt = tilt_deg * kPi / 180;
  return {.matter = Matter::sand,
          .box_mm = box_mm,
          .fill_mm = fill_mm,
          .spacing_mm = 10,
          .density_kg_m3 = 1600,
          .friction = friction,
          .gravity_m_s2 = kGravity_m_s2 * DVec3(std::sin(tilt), -std::cos(tilt), 0),
          .periodic = {false, false, true}};
}

// Angle of the surface to the horizontal after a bed has slid in a box that is tilted by 45 degrees.
double angleOfRepose_deg(double friction) {
  const MatterScene scene = sandbox({240, 240, 80}, {240, 80, 80}, friction, 45);
  MatterWorld world(scene, {.threads = 2});
  run(world, 1000);
  CHECK(world.observe().kinetic_J < 1e-3);
  constexpr std::size_t kColumns = 24, kFromEnds = 5;
  std::array<double, kColumns> top{};
  for (const Vec3& place : world.particles().positions()) {
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
  constexpr double kTilt_deg = 30;
  const double down = kGravity_m_s2 * std::sin(kTilt_deg * kPi / 180),
               across = kGravity_m_s2 * std::cos(kTilt_deg * kPi / 180);
  for (const double friction : {0.0, 0.2, 0.4, 0.6, 0.9}) {
    CAPTURE(friction);
    const MatterScene scene = sandbox({1000, 100, 80}, {10, 10, 10}, friction, kTilt_deg);
    MatterWorld world(scene, {.threads = 1}, {Vec3(0.1f, 0.005f, 0.04f)});
    run(world, 100);
    const double before = world.velocitiesById()[0].x;
    run(world, 200);
    const double acceleration = (world.velocitiesById()[0].x - before) / 0.2;
    if (friction > down / across) {
      run(world, 500);  // it swings on what friction gives in before it stands
      const float place = world.positionsById()[0].x;
      run(world, 200);
      CHECK(std::abs(world.velocitiesById()[0].x) < 1e-5);
      CHECK(std::abs(world.positionsById()[0].x - place) < 1e-6);
    } else {
      CHECK(isWithin(0.02, acceleration, down - friction * across));
    }
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

TEST_CASE("a heap of sand does not creep, keeps its momentum's account, and is the same for any number of threads") {
  MatterScene scene = sandbox({240, 200, 80}, {100, 120, 80}, 0.5, 0);
  MatterWorld one(scene, {.threads = 1}), three(scene, {.threads = 3});
  run(one, 800);
  run(three, 800);
  CHECK(sameBytes(one, three));
  const MatterImpulses& given = one.impulses();
  const DVec3 missing = one.observe().momentum - (given.gravity - given.onWalls);
  CHECK(glm::length(missing) <= 1e-5 * glm::length(given.gravity));
  const std::vector<Vec3> before = one.positionsById();
  run(one, 500);
  const std::vector<Vec3> after = one.positionsById();
  double farthest = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    farthest = std::max(farthest, double(glm::length(after[i] - before[i])));
  CHECK(farthest < 1e-3);
}

TEST_CASE("a ball that is pushed into sand is pushed back") {
  MatterScene scene = sandbox({140, 200, 140}, {140, 80, 140}, 0.5, 0);
  scene.tool = {.radius_mm = 30, .mass_kg = 0.2};
  MatterWorld world(scene, {.threads = 2, .tools = 1});
  HandPose hand{.place_m = {0.07, 0.15, 0.07}};
  for (int k = 0; k < 500; ++k) {
    hand.place_m.y -= 1e-4;
    world.step({&hand, 1});
  }
  REQUIRE(world.state() == MatterState::running);
  CHECK(world.answers()[0].reaction_N.y > 0.5);
  CHECK(world.portEnergy_J(0) > 0);
  const MatterImpulses& given = world.impulses();
  const DVec3 missing = world.observe().momentum - (given.gravity - given.onWalls - given.onTools);
  CHECK(glm::length(missing) <= 1e-5 * glm::length(given.gravity));
}

}  // namespace palpate
