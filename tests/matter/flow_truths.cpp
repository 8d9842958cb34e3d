// What water that flows has to be true to.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/matter/matter_truths.hpp"

namespace palpate {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kLayers = 12;
constexpr double kAcross_m = 0.012, kLayer_m = kAcross_m / kLayers;

// Between two plates, and endless along them.
MatterScene channel(double viscosity_Pa_s, const DVec3& pull_m_s2) {
  return {.box_mm = {8, 12, 8},
          .fill_mm = {8, 12, 8},
          .spacing_mm = 1,
          .viscosity_Pa_s = viscosity_Pa_s,
          .gravity_m_s2 = pull_m_s2,
          .periodic = {true, false, true}};
}

// How far layers are from where they should be, m/s: means over the particles of each.
std::array<double, kLayers> missedBy(const MatterSimulation& world, const std::function<double(double)>& velocityAt) {
  std::array<double, kLayers> sums{}, counts{};
  const std::vector<Vec3> positions = world.positionsById(), velocities = world.velocitiesById();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double y = positions[i].y;
    const auto layer = std::min(static_cast<std::size_t>(y / kLayer_m), kLayers - 1);
    sums[layer] += static_cast<double>(velocities[i].x) - velocityAt(y);
    ++counts[layer];
  }
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    REQUIRE(counts[layer] > 0);
    sums[layer] = std::abs(sums[layer]) / counts[layer];
  }
  return sums;
}

}  // namespace

void checkPoiseuille(const MatterMaker& make, double viscosity_Pa_s, int steps) {
  constexpr double kPull_m_s2 = 1;
  const MatterScene scene = channel(viscosity_Pa_s, {kPull_m_s2, 0, 0});
  const auto world = make(scene, 0, placesAtRest(scene));
  run(*world, steps);
  const double curvature = kPull_m_s2 * scene.density_kg_m3 / viscosity_Pa_s / 2;
  const double most_m_s = curvature * kAcross_m * kAcross_m / 4;
  const auto missed = missedBy(*world, [&](double y) { return curvature * y * (kAcross_m - y); });
  checkAtMost(fmt::format("Poiseuille at {:g} Pa s, layers, % of the highest velocity", viscosity_Pa_s),
              100 * *std::ranges::max_element(missed) / most_m_s, 3);
}

void checkCouette(const MatterMaker& make, double viscosity_Pa_s) {
  constexpr std::size_t kBelow = 9;  // layers; the plate is above them
  constexpr double kPlate_m = kBelow * kLayer_m, kSpeed_m_s = 0.1;
  const MatterScene scene = channel(viscosity_Pa_s, DVec3(0));
  const auto world = make(scene, 0, placesAtRest(scene));
  // The time in which motion spreads from one plate to the other.
  const double spread_s = kPlate_m * kPlate_m * scene.density_kg_m3 / viscosity_Pa_s;
  const auto velocityAt = [&](double y) {
    const double high = y / kPlate_m;
    double share = high;
    for (int n = 1; n < 20; ++n)
      share += 2 * (n % 2 == 0 ? 1 : -1) / (n * kPi) * std::exp(-n * n * kPi * kPi * world->time_s() / spread_s) *
               std::sin(n * kPi * high);
    return kSpeed_m_s * share;
  };
  const auto goTo = [&](double time_s) {
    while (world->time_s() < time_s) {
      const std::vector<Vec3> positions = world->positionsById();
      std::vector<Vec3> velocities = world->velocitiesById();
      // What is above the plane of the plate has the velocities with which that plane moves as a plate.
      for (std::size_t i = 0; i < positions.size(); ++i)
        if (const double high = positions[i].y / kPlate_m; high > 1)
          velocities[i] = Vec3(static_cast<float>(kSpeed_m_s * high), 0, 0);
      world->setVelocities(velocities);
      run(*world, 1);
    }
    const auto missed = missedBy(*world, velocityAt);
    return 100 * *std::max_element(missed.begin(), missed.begin() + kBelow) / kSpeed_m_s;
  };
  const std::string what = fmt::format("Couette at {:g} Pa s, layers, % of the velocity of the plate, ", viscosity_Pa_s);
  // Those velocities are of the plate in the end, so that it drags a little less while motion spreads.
  checkAtMost(what + "after 0.15 times of spreading", goTo(0.15 * spread_s), 5);
  checkAtMost(what + "at last", goTo(spread_s), 1);
}

namespace {

// A pressure in water that stands, Pa, and how far a dam that breaks has come, m.
struct BySubsteps {
  double pressure_Pa = 0, front_m = 0;
};

BySubsteps bySubsteps(const MatterMaker& make, std::uint32_t times, int settling, int steps) {
  BySubsteps is;
  MatterScene still = tank({8, 16, 8}, 12), dam = matterSceneNamed("dam");
  still.substeps = times * planOf(still).substeps;
  dam.substeps = times * planOf(dam).substeps;
  const auto standing = atRest(make, still), breaking = atRest(make, dam);
  run(*standing, settling);
  for (int k = 0; k < steps; ++k) {
    run(*standing, 1);
    is.pressure_Pa += standing->pressureAt({0.04, 0.04, 0.04}) / steps;
  }
  run(*breaking, 200);
  is.front_m = breaking->observe().front_m;
  return is;
}

}  // namespace

void checkWaterByAnySubsteps(const MatterMaker& make, const std::vector<std::uint32_t>& times, int settling, int steps) {
  const BySubsteps needed = bySubsteps(make, 1, settling, steps);
  for (const std::uint32_t more : times) {
    const BySubsteps is = bySubsteps(make, more, settling, steps);
    checkTruth(fmt::format("pressure with {} times the substeps, Pa", more), is.pressure_Pa, needed.pressure_Pa, 0.02);
    checkTruth(fmt::format("front of a dam with {} times the substeps, mm", more), 1e3 * is.front_m, 1e3 * needed.front_m,
               0.03);
  }
}

}  // namespace palpate
