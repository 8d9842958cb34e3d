// Water that flows: against the parabola of a viscous channel, and against what was measured of a dam that breaks.
#include <array>
#include <cmath>

#include "tests/matter/matter_scenes.hpp"

namespace palpate {

namespace {

struct Front {
  double time, place;  // t sqrt(2 g / a), Z / a; a is the width of the column
};

// Martin and Moyce 1952 ("An experimental study of the collapse of liquid columns on a rigid horizontal plane"), fig.
// 3, n^2 = 2, a = 2.25 in, up to four widths.
constexpr std::array kMartinMoyce{Front{0.832, 1.217}, Front{1.219, 1.474}, Front{1.997, 2.292}, Front{2.547, 2.995},
                                  Front{3.345, 4.134}};
// Koshizuka and Oka 1996 ("Moving-particle semi-implicit method for fragmentation of incompressible fluid"): their
// method.
constexpr std::array kKoshizukaOka{Front{0.778, 1.351}, Front{1.226, 1.771}, Front{1.684, 2.268},
                                   Front{2.043, 2.707}, Front{2.451, 3.251}, Front{2.943, 3.997}};

double frontAt(const std::vector<Front>& way, double time) {
  for (std::size_t k = 1; k < way.size(); ++k)
    if (way[k].time >= time) {
      const double share = (time - way[k - 1].time) / (way[k].time - way[k - 1].time);
      return way[k - 1].place + share * (way[k].place - way[k - 1].place);
    }
  FAIL("the front did not get so far in time");
  return 0;
}

}  // namespace

TEST_CASE("a dam that breaks sends its front as far as experiments and another method have it") {
  const MatterScene scene = matterSceneNamed("dam");
  const double width_m = scene.fill_mm.x * 1e-3;
  REQUIRE(scene.fill_mm.y == 2 * scene.fill_mm.x);
  MatterWorld world(scene, {.threads = 2});
  std::vector<Front> way{{0, 1}};
  while (way.back().time < 3.4) {
    run(world, 1);
    way.push_back({world.time_s() * std::sqrt(2 * kGravity_m_s2 / width_m), world.observe().front_m / width_m});
  }
  // Experiments lag in the beginning, where a gate is drawn: at 1.2 their own spread is 5 %, and that other method is
  // 20 % ahead of them.
  for (const Front& measured : kMartinMoyce) {
    CAPTURE(measured.time);
    CHECK(isWithin(measured.time < 1.5 ? 0.15 : 0.1, frontAt(way, measured.time), measured.place));
  }
  for (const Front& computed : kKoshizukaOka) {
    CAPTURE(computed.time);
    CHECK(isWithin(0.1, frontAt(way, computed.time), computed.place));
  }
}

TEST_CASE("between two plates water flows with the parabola that its viscosity says") {
  constexpr double kAcross_m = 0.012, kPull_m_s2 = 1;
  for (const double viscosity_Pa_s : {0.1, 0.3}) {
    CAPTURE(viscosity_Pa_s);
    MatterScene scene{.box_mm = {8, 12, 8}, .fill_mm = {8, 12, 8}, .spacing_mm = 1, .viscosity_Pa_s = viscosity_Pa_s};
    scene.gravity_m_s2 = {kPull_m_s2, 0, 0};
    scene.periodic = {true, false, true};
    MatterWorld world(scene, {.threads = 2});
    run(world, 1000);
    const double curvature = kPull_m_s2 * scene.density_kg_m3 / viscosity_Pa_s / 2;
    const double most_m_s = curvature * kAcross_m * kAcross_m / 4;
    std::array<double, 12> sums{}, expected{}, counts{};
    const std::vector<Vec3> positions = world.positionsById(), velocities = world.velocitiesById();
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double y = positions[i].y;
      const auto layer = static_cast<std::size_t>(y / kAcross_m * 12);
      sums[layer] += velocities[i].x;
      expected[layer] += curvature * y * (kAcross_m - y);
      ++counts[layer];
    }
    for (std::size_t layer = 0; layer < 12; ++layer) {
      CAPTURE(layer);
      REQUIRE(counts[layer] > 0);
      CHECK(std::abs(sums[layer] - expected[layer]) / counts[layer] <= 0.03 * most_m_s);
    }
  }
}

}  // namespace palpate
