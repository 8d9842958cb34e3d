// Required accuracy of flowing water.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/matter/matter_truths.hpp"

namespace palpate {

namespace {

constexpr std::size_t kLayers = 12;
constexpr double kAcross_m = 0.012, kLayer_m = kAcross_m / kLayers;

// Between two plates, and periodic along them.
MatterScene channel(double viscosity_Pa_s, const DVec3& pull_m_s2) {
  return {.box_mm = {8, 12, 8},
          .fill_mm = {8, 12, 8},
          .spacing_mm = 1,
          .viscosity_Pa_s = viscosity_Pa_s,
          .gravity_m_s2 = pull_m_s2,
          .periodic = {true, false, true}};
}

std::size_t layerOf(double y) { return std::min(static_cast<std::size_t>(y / kLayer_m), kLayers - 1); }

// Mean excess of the particles' velocity over the expected one, per layer, m/s.
std::array<double, kLayers> beyond(const MatterSimulation& world, const std::function<double(double)>& velocityAt) {
  std::array<double, kLayers> means{}, counts{};
  const std::vector<Vec3> positions = world.positionsById(), velocities = world.velocitiesById();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double y = positions[i].y;
    means[layerOf(y)] += static_cast<double>(velocities[i].x) - velocityAt(y);
    ++counts[layerOf(y)];
  }
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    REQUIRE(counts[layer] > 0);
    means[layer] /= counts[layer];
  }
  return means;
}

// Largest excess of the first `layers` layers relative to the highest velocity, %.
double worstOf(const MatterSimulation& world, const std::function<double(double)>& velocityAt, std::size_t layers,
               double most_m_s) {
  const auto means = beyond(world, velocityAt);
  double worst = 0;
  for (std::size_t layer = 0; layer < layers; ++layer) worst = std::max(worst, std::abs(means[layer]));
  return 100 * worst / most_m_s;
}

}  // namespace

void checkPoiseuille(const MatterMaker& make, double viscosity_Pa_s, int steps) {
  constexpr double kPull_m_s2 = 1;
  const MatterScene scene = channel(viscosity_Pa_s, {kPull_m_s2, 0, 0});
  const auto world = make(scene, 0, placesAtRest(scene));
  run(*world, steps);
  const double curvature = kPull_m_s2 * scene.density_kg_m3 / viscosity_Pa_s / 2;
  const double most_m_s = curvature * kAcross_m * kAcross_m / 4;
  const auto parabola = [&](double y) { return curvature * y * (kAcross_m - y); };
  checkAtMost(fmt::format("Poiseuille at {:g} Pa s, layers, % of the highest velocity", viscosity_Pa_s),
              worstOf(*world, parabola, kLayers, most_m_s), 3);
}

void checkCouette(const MatterMaker& make, double viscosity_Pa_s) {
  constexpr std::size_t kBelow = 9;  // layers; the plate is above them
  constexpr double kPlate_m = kBelow * kLayer_m, kSpeed_m_s = 0.1;
  const MatterScene scene = channel(viscosity_Pa_s, DVec3(0));
  const auto world = make(scene, 0, placesAtRest(scene));
  // Diffusion time of momentum from one plate to the other.
  const double spread_s = kPlate_m * kPlate_m * scene.density_kg_m3 / viscosity_Pa_s;
  const auto velocityAt = [&](double y) {
    const double high = y / kPlate_m;
    double share = high;
    for (int n = 1; n < 20; ++n)
      share += 2 * (n % 2 == 0 ? 1 : -1) / (n * std::numbers::pi) *
               std::exp(-n * n * std::numbers::pi * std::numbers::pi * world->time_s() / spread_s) *
               std::sin(n * std::numbers::pi * high);
    return kSpeed_m_s * share;
  };
  const auto goTo = [&](double time_s) {
    while (world->time_s() < time_s) {
      const std::vector<Vec3> positions = world->positionsById();
      std::vector<Vec3> velocities = world->velocitiesById();
      // The water above the plate mirrors the motion below it, so that the velocity between them is the plate's.
      const auto means = beyond(*world, [](double) { return 0; });
      for (std::size_t i = 0; i < positions.size(); ++i)
        if (const std::size_t layer = layerOf(positions[i].y); layer >= kBelow)
          velocities[i] = Vec3(static_cast<float>(2 * kSpeed_m_s - means[2 * kBelow - 1 - layer]), 0, 0);
      world->setVelocities(velocities);
      run(*world, 1);
    }
    return worstOf(*world, velocityAt, kBelow, kSpeed_m_s);
  };
  const std::string what =
      fmt::format("Couette at {:g} Pa s, layers, % of the velocity of the plate, ", viscosity_Pa_s);
  checkAtMost(what + "after 0.15 times of spreading", goTo(0.15 * spread_s), 1);
  checkAtMost(what + "at last", goTo(spread_s), 1);
}

namespace {

// A pressure in water at rest, Pa, and the position of a dam break's front, m.
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

void checkWaterByAnySubsteps(const MatterMaker& make, const std::vector<std::uint32_t>& times, int settling,
                             int steps) {
  const BySubsteps needed = bySubsteps(make, 1, settling, steps);
  for (const std::uint32_t more : times) {
    const BySubsteps is = bySubsteps(make, more, settling, steps);
    checkTruth(fmt::format("pressure with {} times the substeps, Pa", more), is.pressure_Pa, needed.pressure_Pa, 0.02);
    checkTruth(fmt::format("front of a dam with {} times the substeps, mm", more), 1e3 * is.front_m,
               1e3 * needed.front_m, 0.03);
  }
}

}  // namespace palpate
