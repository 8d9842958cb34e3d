// Water that flows between plates, on each back end.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/labels.hpp"
#include "tests/matter/on_matter.hpp"

namespace palpate::flow_truths_test {

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

TEST_CASE_FIXTURE(OnMatter, "between two plates water flows with the parabola of its viscosity" * kFullOnGpu) {
  const int steps = onCpuOrGpu(1000, 300);
  for (const double viscosity_Pa_s : onCpuOrGpu<std::vector<double>>({0.1, 0.3}, {0.3})) {
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
}

TEST_CASE_FIXTURE(OnMatter, "below a moving plate the speed of water is proportional to its height" * kFullOnGpu) {
  for (const double viscosity_Pa_s : onCpuOrGpu<std::vector<double>>({0.1, 0.3}, {0.3})) {
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
}

}  // namespace palpate::flow_truths_test
