// Shape matching: no force from rigid motion, no net force from the body itself, and no energy from nothing.
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "engine/core/error.hpp"
#include "engine/matter/matter_parameters.hpp"
#include "engine/matter/soft_scene.hpp"
#include "engine/matter/soft_world.hpp"
#include "tests/matter/soft_bodies.hpp"
#include "tests/matter/soft_truths.hpp"

namespace palpate::shape_matching_test {

namespace {

constexpr SoftMaterial kMass{.young_Pa = 1, .poisson = 0, .density_kg_m3 = 1000};
constexpr double kStep_s = 1e-3;

struct MatchedBody {
  SoftSolid solid;
  SoftBody body;
  double step_s;
  WorkerTeam team{2};

  MatchedBody(SoftSolid made, double stiffness, double step = kStep_s)
      : solid(std::move(made)),
        body(solid.lattice, kMass, {}, MatchingRules::inSubstep(stiffness, step)),
        step_s(step) {}

  DVec3 placeOf(std::size_t i) const { return DVec3(solid.lattice.rest()[i]) + DVec3(body.displacements()[i]); }
  SoftSums substep() { return body.substep(DVec3(0), step_s, team); }
  DVec3 angularMomentum() const {
    DVec3 sum(0);
    for (std::size_t i = 0; i < body.size(); ++i)
      sum += static_cast<double>(body.masses()[i]) * glm::cross(placeOf(i), DVec3(body.velocities()[i]));
    return sum;
  }
  // Moves every node randomly by up to `far` spacings, at up to `fast` spacings a step.
  void scatter(float far, float fast, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> to(-1, 1);
    for (std::size_t i = 0; i < body.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        body.displacements()[i][axis] += far * 0.005f * to(random);
        body.velocities()[i][axis] += fast * 0.005f / static_cast<float>(step_s) * to(random);
      }
  }
};

// Nine spacings along one side, so that the last region is narrower, and an odd number of cells along the others.
SoftSolid block() { return boxSolid(DVec3(0.02), kSoftSpacing_m * DVec3(9, 5, 3), kSoftSpacing_m); }

}  // namespace

TEST_CASE("shape matching causes no force for a rotated, shifted or uniformly moving body") {
  for (const double angle : {0.0, 0.8, 3.1}) {
    CAPTURE(angle);
    MatchedBody matched(block(), 0.5);
    const DVec3 axis = glm::normalize(DVec3(1, -2, 0.5)), speed(0.3, -0.2, 0.1);
    const DQuat turn = glm::angleAxis(angle, axis);
    for (std::size_t i = 0; i < matched.body.size(); ++i) {
      const DVec3 rest(matched.solid.lattice.rest()[i]);
      matched.body.displacements()[i] = turn * rest + DVec3(0.03, 0.01, 0) - rest;
      matched.body.velocities()[i] = speed + glm::cross(4.0 * axis, turn * rest);
    }
    double most = 0;
    for (const DVec3& force : matched.body.forces(matched.team)) most = std::max(most, glm::length(force));
    // Force on a node displaced by a spacing.
    const double whole = 0.5 / (kStep_s * kStep_s) * kSoftSpacing_m * 1000 * std::pow(kSoftSpacing_m, 3);
    CHECK(most < 1e-5 * whole);
    CHECK(matched.body.strainEnergy_J() < 1e-9 * whole * kSoftSpacing_m);
  }
}

TEST_CASE("shape matching adds neither linear nor angular momentum, for scattered, flat and inverted bodies") {
  for (const int how : {0, 1, 2}) {
    CAPTURE(how);
    MatchedBody matched(block(), 0.8);
    if (how > 0)
      for (std::size_t i = 0; i < matched.body.size(); ++i)
        matched.body.displacements()[i].y = (how == 1 ? -1.0f : -1.8f) * (matched.solid.lattice.rest()[i].y - 0.03f);
    matched.scatter(how == 0 ? 0.4f : 0.01f, 0.1f, 4);
    const DVec3 turning = matched.angularMomentum();
    DVec3 momentum(0);
    double scale = 0;
    for (std::size_t i = 0; i < matched.body.size(); ++i) {
      const auto mass = static_cast<double>(matched.body.masses()[i]);
      momentum += mass * DVec3(matched.body.velocities()[i]);
      scale += mass * glm::length(DVec3(matched.body.velocities()[i]));
    }
    for (int k = 0; k < 50; ++k) matched.substep();
    const SoftSums after = matched.substep();
    CHECK(glm::length(after.momentum - momentum) < 1e-5 * scale);
    CHECK(glm::length(matched.angularMomentum() - turning) < 1e-4 * scale * 0.05);
  }
}

TEST_CASE("with shape matching energy never grows, for any substep, and every body returns to its shape") {
  for (const double step_s : {1e-4, 1e-3, 2e-2})
    for (const double stiffness : {0.05, 0.5, 0.95})
      for (const bool flat : {false, true}) {
        CAPTURE(step_s);
        CAPTURE(stiffness);
        CAPTURE(flat);
        MatchedBody matched(block(), stiffness, step_s);
        if (flat)
          for (std::size_t i = 0; i < matched.body.size(); ++i)
            matched.body.displacements()[i].z = 0.02f - matched.solid.lattice.rest()[i].z;
        matched.scatter(flat ? 0.02f : 0.45f, 0.1f, 5);
        double kinetic = 0;
        for (std::size_t i = 0; i < matched.body.size(); ++i)
          kinetic += static_cast<double>(matched.body.masses()[i]) *
                     glm::dot(DVec3(matched.body.velocities()[i]), DVec3(matched.body.velocities()[i])) / 2;
        const double first = matched.body.strainEnergy_J() + kinetic;
        double last = first;
        for (int k = 0; k < 3000; ++k) {
          const double now = matched.substep().kinetic_J + matched.body.strainEnergy_J();
          REQUIRE(now <= last + 1e-3 * first);
          last = now;
        }
        // Only rigid motion remains.
        CHECK(matched.body.strainEnergy_J() < 1e-5 * first);
      }
}

TEST_CASE("the force of shape matching is the derivative of its energy, less the share of the substep") {
  constexpr double kStiffness = 0.3;
  MatchedBody matched(block(), kStiffness);
  matched.scatter(0.2f, 0, 6);
  const std::vector<DVec3> forces = matched.body.forces(matched.team);
  double most = 0;
  for (const DVec3& force : forces) most = std::max(most, glm::length(force));
  for (const std::size_t node : {std::size_t{0}, std::size_t{61}, std::size_t{100}, matched.body.size() - 1})
    for (int axis = 0; axis < 3; ++axis) {
      constexpr float kWay = 2e-6f;
      float& at = matched.body.displacements()[node][axis];
      const float before = at;
      at = before + kWay;
      const double more_J = matched.body.strainEnergy_J(), up = static_cast<double>(at);
      at = before - kWay;
      const double less_J = matched.body.strainEnergy_J(), way = up - static_cast<double>(at);
      at = before;
      CHECK(std::abs((1 - kStiffness) * (more_J - less_J) / way + forces[node][axis]) < 2e-3 * most);
    }
}

TEST_CASE("a body with shape matching bends, rests in its given shape, and needs one substep") {
  MatterScene scene = softBlock();
  scene.fill_mm = {30, 40, 30};
  scene.preset = SoftPreset::shapeMatching;
  CHECK(planOf(scene).substeps == 1);
  CHECK(planOf(softBlock()).substeps > 4);
  scene.tool = {};
  SoftWorld world(scene, {.threads = 1});
  SoftWorld three(scene, {.threads = 3});
  run(world, 2500);
  run(three, 2500);
  CHECK(world.positionsById() == three.positionsById());
  CHECK(world.observe().kinetic_J < 1e-8);
  const double weight = 0.03 * 0.03 * 0.04 * 1000 * kGravity_m_s2;
  const DVec3 before = world.impulses().onWalls;
  run(world, 200);
  CHECK(isWithin(0.01, -(world.impulses().onWalls - before).y / 0.2, weight));
  SoftSculpture& sculpture = *world.sculpture();
  std::vector<PlaceWay> ways;
  for (std::uint32_t i = 0; i < sculpture.surface().size(); ++i)
    if (sculpture.surface().placeOf(world.body(), i).y > 0.038f) ways.push_back({.place = i, .way = {0, -1e-3, 0}});
  for (int tick = 0; tick < 5; ++tick) sculpture.yield(ways);
  sculpture.endStroke();
  const auto top = [&] {
    double sum = 0;
    for (const PlaceWay& way : ways) sum += static_cast<double>(sculpture.surface().placeOf(world.body(), way.place).y);
    return sum / static_cast<double>(ways.size());
  };
  const double sculpted = top();
  CHECK(sculpted < 0.037);
  run(world, 2500);
  CHECK(std::abs(top() - sculpted) < 1e-4);
  CHECK(world.observe().kinetic_J < 1e-8);
}

TEST_CASE("with shape matching random hands gain no energy, and momentum balances walls, pins and balls") {
  const SoftMaker matched = [](const MatterScene& scene, std::size_t tools, const SoftSolid* solid,
                               std::span<const SurfacePlace> points) {
    MatterScene other = scene;
    other.preset = SoftPreset::shapeMatching;
    return softOnCpu()(other, tools, solid, points);
  };
  checkSoftPortEnergy(matched, 2, 800);
  checkSoftMomentum(matched, 300);
  checkPinsHold(matched, 50);
}

TEST_CASE("with shape matching the stiffness can change during a simulation, and the modulus has no effect") {
  MatterScene scene = softBlock();
  scene.preset = SoftPreset::shapeMatching;
  scene.stiffness = 0.05;
  scene.tool = {};
  SoftWorld world(scene);
  const auto top = [&] {
    float highest = 0;
    for (const Vec3& place : world.positionsById()) highest = std::max(highest, place.y);
    return static_cast<double>(highest);
  };
  run(world, 1500);
  const double soft = top();
  setParameter(scene, "stiffness", 0.8);
  world.change(scene);
  run(world, 1500);
  CHECK(top() > soft + 1e-3);
  CHECK_THROWS_WITH_AS(setParameter(scene, "young_Pa", 1e4), doctest::Contains("young_Pa: is not a parameter"), Error);
  scene.preset = SoftPreset::elastic;
  CHECK_THROWS_WITH_AS(setParameter(scene, "stiffness", 0.2), doctest::Contains("stiffness: is not a parameter"),
                       Error);
}

}  // namespace palpate::shape_matching_test
