// Soft bodies in motion: rotations, momentum, frequencies, and the same bytes for any number of threads.
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "tests/matter/soft_bodies.hpp"

namespace palpate::soft_motion_test {

namespace {

constexpr SoftMaterial kJelly{.young_Pa = 5e4, .poisson = 0.4, .density_kg_m3 = 1000, .viscosity_Pa_s = 0};

SoftSolid block(const DVec3& spacings) { return boxSolid(DVec3(0), spacings * kSoftSpacing_m, kSoftSpacing_m); }

// Stress of a deformation gradient, relative to rest, in double precision.
glm::dmat3 stressOf(const glm::dmat3& f, const SoftMaterial& material) {
  const shared::SoftRules rules = softRules(material, kSoftSpacing_m);
  const shared::SoftRulesOf<double> precise{.shear = rules.shear,
                                            .bulk = rules.bulk,
                                            .restVolume = 1 + 0.75 * rules.shear / rules.bulk,
                                            .viscosity = rules.viscosity,
                                            .bend = 0,
                                            .twist = 0,
                                            .bendDrag = 0,
                                            .perEdges = 1};
  return shared::softStress(precise, f, glm::dmat3(0));
}

}  // namespace

TEST_CASE("a small strain has the stress of Hooke's law at any rotation") {
  const glm::dmat3 strain(DVec3(1, 0.3, -0.2), DVec3(0.3, -0.5, 0.4), DVec3(-0.2, 0.4, 0.2));
  const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(2.0, glm::normalize(DVec3(1, 2, -1))));
  for (const double poisson : {0.0, 0.25, 0.45}) {
    SoftMaterial material = kJelly;
    material.poisson = poisson;
    constexpr double kSmall = 1e-5;
    const double lame = material.bulk_Pa() - 2.0 / 3 * material.shear_Pa();
    const double trace = strain[0][0] + strain[1][1] + strain[2][2];
    const glm::dmat3 expected = kSmall * (2 * material.shear_Pa() * strain + glm::dmat3(lame * trace));
    const glm::dmat3 stress = glm::transpose(turn) * stressOf(turn * (glm::dmat3(1) + kSmall * strain), material);
    for (int k = 0; k < 3; ++k) CHECK(glm::length(stress[k] - expected[k]) <= 1e-3 * kSmall * material.young_Pa);
  }
}

TEST_CASE("stress is the derivative of the energy") {
  const glm::dmat3 f(DVec3(1.2, 0.1, -0.3), DVec3(0.2, 0.7, 0.1), DVec3(0.0, 0.4, 1.1));
  const shared::SoftRules rules = softRules(kJelly, kSoftSpacing_m);
  const shared::SoftRulesOf<double> precise{.shear = rules.shear,
                                            .bulk = rules.bulk,
                                            .restVolume = rules.restVolume,
                                            .viscosity = 0,
                                            .bend = 0,
                                            .twist = 0,
                                            .bendDrag = 0,
                                            .perEdges = 1};
  const glm::dmat3 stress = shared::softStress(precise, f, glm::dmat3(0));
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      glm::dmat3 more = f, less = f;
      more[column][row] += 1e-5;
      less[column][row] -= 1e-5;
      const double slope = (shared::softEnergy(precise, more) - shared::softEnergy(precise, less)) / 2e-5;
      CHECK(std::abs(slope - stress[column][row]) <= 1e-6 * kJelly.young_Pa);
    }
}

TEST_CASE("viscous stress follows the rate of Green's strain and is zero for a rotation") {
  const glm::dmat3 f(DVec3(1.2, 0.1, -0.3), DVec3(0.2, 0.7, 0.1), DVec3(0.0, 0.4, 1.1));
  const glm::dmat3 rate(DVec3(3, -1, 2), DVec3(0.5, 4, 2), DVec3(1, 1, -3));
  const shared::SoftRulesOf<double> rules{
      .shear = 0, .bulk = 0, .restVolume = 1, .viscosity = 5, .bend = 0, .twist = 0, .bendDrag = 0, .perEdges = 1};
  const glm::dmat3 stress = shared::softStress(rules, f, rate);
  const glm::dmat3 expected = 5.0 * f * (glm::transpose(rate) * f + glm::transpose(f) * rate);
  const glm::dmat3 spin(DVec3(0, 1, -2), DVec3(-1, 0, 3), DVec3(2, -3, 0));
  const glm::dmat3 turning = shared::softStress(rules, f, spin * f);
  for (int k = 0; k < 3; ++k) {
    CHECK(glm::length(stress[k] - expected[k]) < 1e-12);
    CHECK(glm::length(turning[k]) < 1e-12);
  }
}

TEST_CASE("bending that a cell's centre cannot detect has energy and viscous damping") {
  const double h = kSoftSpacing_m, volume = h * h * h;
  // u_x = x y strains by y, as in a beam; u_x = x y z by y z. Their mean squares over the cell are h^2 / 12 and h^4 /
  // 144.
  const auto bent = [&](bool twisted, TestBody& cell) {
    for (std::size_t i = 0; i < 8; ++i) {
      const DVec3 arm = DVec3(cell.solid.lattice.rest()[i]) - h / 2;
      cell.body.displacements()[i].x = static_cast<float>(arm.x * arm.y * (twisted ? arm.z / h : 1.0));
    }
    return cell.body.strainEnergy_J();
  };
  TestBody cell(block({1, 1, 1}), kJelly);
  CHECK(isWithin(0.01, bent(false, cell), volume * kJelly.young_Pa * h * h / 24));
  CHECK(isWithin(0.01, bent(true, cell), volume * kJelly.young_Pa * h * h / 288));
  // A viscosity n dissipates energy at the rate at which Young's modulus 3 n would store it: a decay of 4 n / rho h^2.
  SoftMaterial syrup = kJelly;
  syrup.viscosity_Pa_s = 0.5;
  TestBody damped(block({1, 1, 1}), syrup);
  damped.step_s /= 20;
  const double before_J = bent(false, damped), rate = 4 * syrup.viscosity_Pa_s / (syrup.density_kg_m3 * h * h);
  double kinetic_J = 0;
  for (int k = 0; k < 1.0 / rate / damped.step_s; ++k) kinetic_J = damped.substep().kinetic_J;
  CHECK(isWithin(0.1, damped.body.strainEnergy_J() + kinetic_J, before_J * std::exp(-1.0)));
}

TEST_CASE("a rotated body has no stress, and a continued rotation is not damped") {
  const DVec3 axis = glm::normalize(DVec3(1, -2, 0.5));
  for (const double angle : {0.3, 1.6, 3.1}) {
    SoftMaterial syrup = kJelly;
    syrup.viscosity_Pa_s = 20;
    TestBody turned(block({6, 5, 4}), syrup);
    const DQuat turn = glm::angleAxis(angle, axis);
    const DVec3 middle = kSoftSpacing_m / 2 * DVec3(6, 5, 4), spin = 3.0 * axis;
    for (std::size_t i = 0; i < turned.body.size(); ++i) {
      const DVec3 arm = DVec3(turned.solid.lattice.rest()[i]) - middle;
      turned.body.displacements()[i] = turn * arm - arm;
      turned.body.velocities()[i] = glm::cross(spin, turn * arm);
    }
    // In units of the force on a node at a strain of 1.
    const double unit = kJelly.young_Pa * kSoftSpacing_m * kSoftSpacing_m;
    for (const DVec3& force : turned.body.forces(turned.team)) REQUIRE(glm::length(force) <= 1e-5 * unit);
    CHECK(std::abs(turned.body.strainEnergy_J()) <= 1e-5 * kJelly.young_Pa * turned.solid.lattice.volume_m3());
  }
}

TEST_CASE("momentum is conserved without gravity and pins, and balances them otherwise") {
  std::mt19937 random(3);
  std::normal_distribution<float> speed(0, 0.3f);
  for (const bool held : {false, true}) {
    CAPTURE(held);
    const std::vector<PlaceBox> pins(held ? 1 : 0, sheetAt(0));
    SoftMaterial jelly = kJelly;
    jelly.viscosity_Pa_s = 3;
    TestBody body(block({8, 4, 5}), jelly, pins);
    DVec3 before(0), gone(0);
    double scale = 0;
    for (std::size_t i = 0; i < body.body.size(); ++i) {
      if (body.body.isPinned(i)) continue;
      for (int axis = 0; axis < 3; ++axis) body.body.velocities()[i][axis] = speed(random);
      before += static_cast<double>(body.body.masses()[i]) * DVec3(body.body.velocities()[i]);
    }
    DVec3 momentum = before;
    for (int k = 0; k < 1000; ++k) {
      const SoftSums sums = body.substep(held ? DVec3(0, -9.81, 0) : DVec3(0));
      gone += sums.gravityImpulse - sums.pinImpulse;
      scale += glm::length(sums.gravityImpulse) + glm::length(sums.pinImpulse);
      momentum = sums.momentum;
    }
    CHECK(glm::length(momentum - before - gone) <= 1e-5 * (glm::length(before) + scale));
    CHECK((scale > 0) == held);
  }
}

TEST_CASE("a strained, released body keeps energy and angular momentum; viscosity reduces only the energy") {
  const auto angular = [](const TestBody& body) {
    DVec3 sum(0);
    for (std::size_t i = 0; i < body.body.size(); ++i)
      sum += static_cast<double>(body.body.masses()[i]) *
             glm::cross(DVec3(body.solid.lattice.rest()[i]) + DVec3(std::as_const(body.body).displacements()[i]),
                        DVec3(std::as_const(body.body).velocities()[i]));
    return sum;
  };
  for (const double viscosity : {0.0, 20.0}) {
    CAPTURE(viscosity);
    SoftMaterial jelly = kJelly;
    jelly.viscosity_Pa_s = viscosity;
    TestBody body(block({8, 4, 4}), jelly);
    body.step_s /= 8;  // energy is that of half a substep earlier
    for (std::size_t i = 0; i < body.body.size(); ++i) {
      const Vec3 rest = body.solid.lattice.rest()[i];
      body.body.displacements()[i] = {0.05f * rest.x, 0.03f * rest.x, 0};
      body.body.velocities()[i] = Vec3(glm::cross(DVec3(0, 5, 8), DVec3(rest)));
    }
    const DVec3 turnBefore = angular(body);
    const double before_J = body.substep().kinetic_J + body.body.strainEnergy_J();
    double after_J = 0;
    for (int k = 0; k < 6000; ++k) after_J = body.substep().kinetic_J;
    after_J += body.body.strainEnergy_J();
    CHECK(glm::length(angular(body) - turnBefore) <= 0.002 * glm::length(turnBefore));
    if (viscosity == 0)
      CHECK(isWithin(0.02, after_J, before_J));
    else
      CHECK(after_J < 0.9 * before_J);
  }
}

TEST_CASE("a released bar vibrates lengthwise, and a beam sideways, at their theoretical frequencies") {
  const double length = 20 * kSoftSpacing_m, height = 3 * kSoftSpacing_m;
  // Oscillations per second, from the times at which the end passes its rest position upwards.
  const auto frequency = [&](double poisson, int axis, double begin) {
    SoftMaterial material = kJelly;
    material.poisson = poisson;
    TestBody bar(block({20, 3, 3}), material, std::array{sheetAt(0)});
    for (std::size_t i = 0; i < bar.body.size(); ++i) {
      const double x = static_cast<double>(bar.solid.lattice.rest()[i].x) / length;
      if (axis == 0) {
        bar.body.displacements()[i].x = static_cast<float>(begin * std::sin(1.5708 * x));
        continue;
      }
      // As under a uniform load, with cross sections perpendicular to the axis.
      const double slope = begin * x * (12 - 12 * x + 4 * x * x) / 3 / length;
      const double above = static_cast<double>(bar.solid.lattice.rest()[i].y) - height / 2;
      bar.body.displacements()[i] = DVec3(-above * slope, begin * x * x * (6 - 4 * x + x * x) / 3, 0);
    }
    const std::size_t end = nodesIn(bar.solid.lattice, sheetAt(length)).front();
    float before = 1;
    double first = 0, last = 0;
    int rounds = -1;
    for (int k = 0; rounds < 4; ++k) {
      bar.substep();
      const float now = std::as_const(bar.body).displacements()[end][axis];
      if (before < 0 && now >= 0) {
        last = k * bar.step_s;
        if (++rounds == 0) first = last;
      }
      before = now;
    }
    return rounds / (last - first);
  };
  const double wave = std::sqrt(kJelly.young_Pa / kJelly.density_kg_m3);
  checkTruth("frequency of a bar along itself, Hz", frequency(0.0, 0, 1e-3), wave / (4 * length), 0.01);
  // Euler and Bernoulli, minus shear and rotary inertia for a beam of this length (Timoshenko 1921).
  const double slender = 3.516 / 6.2832 * wave * height / std::sqrt(12.0) / (length * length);
  checkTruth("frequency of a beam across, Hz", frequency(0.0, 1, 1e-3), slender, 0.03);
}

TEST_CASE("soft bodies give the same results bit by bit with one thread and with three") {
  TestBody one(block({9, 9, 9}), kJelly, std::array{sheetAt(0)}),
      three(block({9, 9, 9}), kJelly, std::array{sheetAt(0)});
  WorkerTeam single(1), team(3);
  for (int k = 0; k < 200; ++k) {
    const SoftSums a = one.body.substep({0, -9.81, 0}, one.step_s, single);
    const SoftSums b = three.body.substep({0, -9.81, 0}, three.step_s, team);
    REQUIRE(a.momentum == b.momentum);
    REQUIRE(a.leastVolume == b.leastVolume);
  }
  const auto bytes = one.body.size() * sizeof(Vec3);
  CHECK(std::memcmp(one.body.displacements().data(), three.body.displacements().data(), bytes) == 0);
  CHECK(std::memcmp(one.body.velocities().data(), three.body.velocities().data(), bytes) == 0);
}

}  // namespace palpate::soft_motion_test
