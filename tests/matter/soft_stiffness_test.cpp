// Soft bodies at rest under loads, compared with the theory of elasticity for bars and beams.
#include <cmath>

#include "tests/matter/soft_bodies.hpp"

namespace palpate::soft_stiffness_test {

namespace {

constexpr double kYoung_Pa = 5e4;

SoftMaterial material(double poisson) { return {.young_Pa = kYoung_Pa, .poisson = poisson, .density_kg_m3 = 1000}; }

// A beam along x from 0, sized in spacings, held at its end.
TestBody beam(const DVec3& spacings, double poisson, double spacing_m = kSoftSpacing_m) {
  return {boxSolid(DVec3(0), spacings * spacing_m, spacing_m), material(poisson), std::array{sheetAt(0)}};
}

// Longitudinal frequency of a bar, and bending frequency of a beam, both held at one end, rad/s.
double stretchFrequency(double length_m) { return 1.571 * std::sqrt(kYoung_Pa / 1000) / length_m; }
double bendFrequency(double length_m, double height_m) {
  return 3.516 * std::sqrt(kYoung_Pa / 12000) * height_m / (length_m * length_m);
}

// Displacement of the free end of a beam under a force, m.
DVec3 endUnder(TestBody& beam, const DVec3& force_N, double length_m, double slowest_rad_s) {
  const auto face = nodesIn(beam.solid.lattice, sheetAt(length_m));
  const auto shares = faceShares(beam.solid.lattice, face);
  beam.relax(slowest_rad_s, [&](std::span<Vec3> loads) {
    for (std::size_t k = 0; k < face.size(); ++k) loads[face[k]] = Vec3(shares[k] * force_N);
  });
  DVec3 mean(0);
  for (std::size_t k = 0; k < face.size(); ++k) mean += shares[k] * DVec3(beam.body.displacements()[face[k]]);
  return mean;
}

}  // namespace

TEST_CASE("a bar has the stiffness E A / L in tension and compression") {
  for (const double poisson : {0.0, 0.3, 0.45}) {
    CAPTURE(poisson);
    for (const double sign : {1.0, -1.0}) {
      TestBody bar = beam({24, 4, 4}, poisson);
      const double length = 24 * kSoftSpacing_m, area = 16 * kSoftSpacing_m * kSoftSpacing_m;
      const double force = sign * 0.002 * kYoung_Pa * area;
      const DVec3 moved = endUnder(bar, {force, 0, 0}, length, stretchFrequency(length));
      checkTruth(fmt::format("E A / L, Poisson's ratio {:g}, {}, N/m", poisson, sign > 0 ? "pulled" : "pressed"),
                 force / moved.x, kYoung_Pa * area / length, 0.02);
    }
  }
}

TEST_CASE("a stretched bar becomes thinner by Poisson's ratio") {
  TestBody bar = beam({24, 4, 4}, 0.4);
  const double area = 16 * kSoftSpacing_m * kSoftSpacing_m;
  endUnder(bar, {0.005 * kYoung_Pa * area, 0, 0}, 24 * kSoftSpacing_m, stretchFrequency(24 * kSoftSpacing_m));
  const auto width = [&](double y) {
    const double x = 12 * kSoftSpacing_m;
    const PlaceBox line{DVec3(x - 1e-6, y - 1e-6, -1), DVec3(x + 1e-6, y + 1e-6, 1)};
    return static_cast<double>(bar.body.displacements()[nodesIn(bar.solid.lattice, line)[2]].y);
  };
  const double thinner = (width(0) - width(4 * kSoftSpacing_m)) / (4 * kSoftSpacing_m);
  checkTruth("how much thinner a bar becomes, Poisson's ratio 0.4, share", thinner, 0.4 * 0.005, 0.03);
}

TEST_CASE("a beam bends by F L^3 / 3 E I plus shear (Timoshenko), with any number of cells over its height") {
  for (const DVec3& spacings : {DVec3(12, 1, 1), DVec3(16, 2, 2), DVec3(30, 4, 3)})
    for (const double poisson : {0.0, 0.3}) {
      CAPTURE(spacings.y);
      CAPTURE(poisson);
      TestBody held = beam(spacings, poisson);
      const double h = kSoftSpacing_m, length = spacings.x * h, height = spacings.y * h, width = spacings.z * h;
      const double inertia = width * std::pow(height, 3) / 12, area = width * height;
      const double shear = kYoung_Pa / (2 * (1 + poisson));
      const double factor = 10 * (1 + poisson) / (12 + 11 * poisson);  // Cowper 1966
      const double perForce = std::pow(length, 3) / (3 * kYoung_Pa * inertia) + length / (factor * shear * area);
      const double force = 0.01 * length / perForce;
      const DVec3 moved = endUnder(held, {0, force, 0}, length, bendFrequency(length, height));
      checkTruth(
          fmt::format("F L^3 / 3 E I with shear, {:g} cells high, Poisson's ratio {:g}, mm", spacings.y, poisson),
          1e3 * moved.y, 1e3 * force * perForce, 0.04);
    }
}

}  // namespace palpate::soft_stiffness_test
