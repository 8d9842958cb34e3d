// Required accuracy of sand.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/matter/matter_truths.hpp"

namespace palpate {

namespace {}  // namespace

MatterScene sandbox(const DVec3& box_mm, const DVec3& fill_mm, double friction, double tilt_deg) {
  const double tilt = tilt_deg * std::numbers::pi / 180;
  return {.matter = Matter::sand,
          .box_mm = box_mm,
          .fill_mm = fill_mm,
          .spacing_mm = 10,
          .density_kg_m3 = 1600,
          .friction = friction,
          .gravity_m_s2 = kGravity_m_s2 * DVec3(std::sin(tilt), -std::cos(tilt), 0),
          .periodic = {false, false, true}};
}

void checkSlope(const MatterMaker& make, double friction) {
  constexpr double kTilt_deg = 30;
  const double down = kGravity_m_s2 * std::sin(kTilt_deg * std::numbers::pi / 180),
               across = kGravity_m_s2 * std::cos(kTilt_deg * std::numbers::pi / 180);
  const MatterScene scene = sandbox({1000, 100, 80}, {10, 10, 10}, friction, kTilt_deg);
  const auto world = make(scene, 0, {Vec3(0.1f, 0.005f, 0.04f)});
  run(*world, 100);
  const double before = world->velocitiesById()[0].x;
  run(*world, 200);
  const double acceleration = (world->velocitiesById()[0].x - before) / 0.2;
  if (friction > down / across) {
    run(*world, 500);  // it oscillates on the contact's compliance before it stops
    const float place = world->positionsById()[0].x;
    run(*world, 200);
    CHECK(std::abs(world->velocitiesById()[0].x) < 1e-5);
    CHECK(std::abs(world->positionsById()[0].x - place) < 1e-6);
  } else {
    checkTruth(fmt::format("acceleration of a grain on a slope of 30 degrees, friction {:g}, m/s^2", friction),
               acceleration, down - friction * across, 0.02);
  }
}

void checkAngleOfRepose(const MatterMaker& make, double friction, double wide_mm, double within_deg) {
  const MatterScene scene = sandbox({240, 240, wide_mm}, {240, 80, wide_mm}, friction, 45);
  const auto world = atRest(make, scene);
  double kinetic_J = 1;
  for (int k = 0; k < 20 && (k < 8 || kinetic_J >= 1e-3); ++k) {
    run(*world, 100);
    kinetic_J = world->totals().kinetic_J;
  }
  CHECK(kinetic_J < 1e-3);
  constexpr std::size_t kColumns = 24, kFromEnds = 5;
  std::array<double, kColumns> top{};
  for (const Vec3& place : world->positionsById()) {
    const auto column = std::min(static_cast<std::size_t>(place.x / 0.01f), kColumns - 1);
    top[column] = std::max(top[column], static_cast<double>(place.y));
  }
  double x = 0, y = 0, xx = 0, xy = 0, count = 0;
  for (std::size_t column = kFromEnds; column < kColumns - kFromEnds; ++column) {
    const double at = 0.01 * static_cast<double>(column);
    x += at, y += top[column], xx += at * at, xy += at * top[column], ++count;
  }
  const double angle_deg = 45 - std::atan((count * xy - x * y) / (count * xx - x * x)) * 180 / std::numbers::pi;
  const double expected_deg = std::atan(std::numbers::pi / 2 * friction) * 180 / std::numbers::pi;
  checkAtMost(fmt::format("angle of repose, friction {:g}, {:.1f} of {:.1f} degrees, away, degrees", friction,
                          angle_deg, expected_deg),
              std::abs(angle_deg - expected_deg), within_deg);
}

void checkHeap(const MatterMaker& make, const DVec3& fill_mm, int falling, int resting) {
  const auto world = atRest(make, sandbox({240, 200, 80}, fill_mm, 0.5, 0));
  run(*world, falling);
  CHECK(missingMomentum(*world) <= 1e-5);
  const std::vector<Vec3> before = world->positionsById();
  run(*world, resting);
  const std::vector<Vec3> after = world->positionsById();
  double farthest = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    farthest = std::max(farthest, double(glm::length(after[i] - before[i])));
  CHECK(farthest < 1e-3);
}

void checkBallInSand(const MatterMaker& make) {
  MatterScene scene = sandbox({100, 160, 100}, {100, 60, 100}, 0.5, 0);
  scene.tool = {.radius_mm = 30, .mass_kg = 0.2};
  const auto world = atRest(make, scene, 1);
  HandPose hand{.place_m = {0.05, 0.1, 0.05}};
  for (int k = 0; k < 300; ++k) {
    hand.place_m.y -= 1e-4;
    world->step({&hand, 1});
  }
  REQUIRE(world->state() == MatterState::running);
  CHECK(world->answers()[0].reaction_N.y > 0.5);
  CHECK(world->portEnergy_J(0) > 0);
  CHECK(missingMomentum(*world) <= 1e-5);
}

}  // namespace palpate
