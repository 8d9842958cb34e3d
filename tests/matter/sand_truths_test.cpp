// Sand on each back end.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/labels.hpp"
#include "tests/matter/on_matter.hpp"

namespace palpate::sand_truths_test {

TEST_CASE_FIXTURE(OnMatter, "a grain on a slope sticks or slides by Coulomb's law" * kMoreInFull) {
  for (const double friction : onCpuOrGpu<std::vector<double>>({0.0, 0.2, 0.4, 0.6, 0.9},
                                                               byTier<std::vector<double>>({0.4}, {0.0, 0.4, 0.9}))) {
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
}

// The slope of a bed that has slid in a box tilted by 45 degrees is pi / 2 times the friction (Caquot 1934, "Equilibre
// des massifs a frottement interne": grains that slide at all contacts and do not rotate). It rests slightly steeper
// because grains also interlock.
TEST_CASE_FIXTURE(OnMatter, "a sliding bed of sand comes to rest at the angle of repose of grains that do not rotate" *
                                kMoreInFull * kFullOnGpu) {
  constexpr double kWide_mm = 70, kWithin_deg = 5;
  for (const double friction : onCpuOrGpu(byTier<std::vector<double>>({0.3}, {0.1, 0.2, 0.3, 0.4}), {0.3})) {
    const MatterScene scene = sandbox({240, 240, kWide_mm}, {240, 80, kWide_mm}, friction, 45);
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
                std::abs(angle_deg - expected_deg), kWithin_deg);
  }
}

TEST_CASE_FIXTURE(OnMatter, "a heap of sand does not creep, and its momentum balances" * kFullOnGpu) {
  const DVec3 fill_mm = onCpuOrGpu(DVec3(100, 120, 80), DVec3(60, 50, 80));
  const auto world = atRest(make, sandbox({240, 200, 80}, fill_mm, 0.5, 0));
  run(*world, onCpuOrGpu(800, 500));
  CHECK(missingMomentum(*world) <= 1e-5);
  const std::vector<Vec3> before = world->positionsById();
  run(*world, onCpuOrGpu(500, 100));
  const std::vector<Vec3> after = world->positionsById();
  double farthest = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    farthest = std::max(farthest, double(glm::length(after[i] - before[i])));
  CHECK(farthest < 1e-3);
}

TEST_CASE_FIXTURE(OnMatter, "sand pushes back a ball that is pushed into it" * kFullOnGpu) {
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

}  // namespace palpate::sand_truths_test
