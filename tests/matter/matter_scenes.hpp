// Scenes and checks shared by the tests.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/matter/matter_world.hpp"
#include "tests/error_of.hpp"

namespace palpate {

inline constexpr double kGravity_m_s2 = 9.81;

/// Makes a simulation with the implementation under test.
using MatterMaker = std::function<std::unique_ptr<MatterSimulation>(const MatterScene& scene, std::size_t tools,
                                                                    std::vector<Vec3> places)>;
inline MatterMaker onCpu(unsigned threads = 2) {
  return [threads](const MatterScene& scene, std::size_t tools, std::vector<Vec3> places) {
    return std::make_unique<MatterWorld>(scene, MatterOptions{.threads = threads, .tools = tools}, std::move(places));
  };
}

/// A tank filled from wall to wall, sized in whole spacings.
inline MatterScene tank(const DVec3& spacings, double filled_spacings, double spacing_mm = 10) {
  return {.box_mm = spacings * spacing_mm,
          .fill_mm = DVec3(spacings.x, filled_spacings, spacings.z) * spacing_mm,
          .spacing_mm = spacing_mm};
}

inline void run(MatterSimulation& world, int steps) {
  for (int k = 0; k < steps; ++k) world.step();
  REQUIRE(world.state() == MatterState::running);
}

inline double massOf(const MatterSimulation& world) {
  return world.plan().mass_kg * static_cast<double>(world.particles());
}

/// Momentum that gravity, walls, tools and model do not account for, relative to that from gravity.
inline double missingMomentum(const MatterSimulation& world) {
  const MatterImpulses& given = world.impulses();
  return glm::length(world.totals().momentum - (given.gravity - given.onWalls - given.onTools - given.onModel)) /
         glm::length(given.gravity);
}

/// Whether a value equals the expected one within a relative tolerance. Prints both if not.
inline bool isWithin(double share, double value, double expected) {
  if (std::abs(value - expected) <= share * std::abs(expected)) return true;
  MESSAGE(value);
  MESSAGE(expected);
  return false;
}

/// Compares a measured quantity with its truth, and prints both, so that a run of the tests yields the table of
/// accuracies (apps/bench/results/matter_truths.json).
inline void checkTruth(const std::string& quantity, double measured, double truth, double share) {
  MESSAGE(fmt::format("{}: {:.4g} of {:.4g}, {:+.2f} % of {:g} %", quantity, measured, truth,
                      100 * (measured - truth) / std::abs(truth), 100 * share));
  CHECK(std::abs(measured - truth) <= share * std::abs(truth));
}

/// The same for an upper bound.
inline void checkAtMost(const std::string& quantity, double measured, double most) {
  MESSAGE(fmt::format("{}: {:.3g} of {:g} at most", quantity, measured, most));
  CHECK(measured <= most);
}

/// Whether two simulations are in the same state, bit by bit.
inline bool sameBytes(const MatterSimulation& a, const MatterSimulation& b) {
  const auto same = [](const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(Vec3)) == 0;
  };
  return same(a.positionsById(), b.positionsById()) && same(a.velocitiesById(), b.velocitiesById());
}

/// The error that rejects a scene; "taken" if it is valid.
inline std::string refusal(const MatterScene& scene, std::uint64_t memory_bytes = std::uint64_t{2} << 30) {
  return errorOf([&] { planOf(scene, memory_bytes); });
}

inline std::unique_ptr<MatterSimulation> atRest(const MatterMaker& make, const MatterScene& scene,
                                                std::size_t tools = 0) {
  return make(scene, tools, placesAtRest(scene));
}

/// Grains on a tilted floor, in a box that is periodic along z.
inline MatterScene sandbox(const DVec3& box_mm, const DVec3& fill_mm, double friction, double tilt_deg) {
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

/// A long block of water in the air, 1 mm apart, with cohesion.
inline MatterScene floatingBlock(double cohesion_N_m) {
  return {.box_mm = {36, 30, 30},
          .fill_mm = {16, 8, 8},
          .fill_at_mm = {10, 11, 11},
          .spacing_mm = 1,
          .viscosity_Pa_s = 5e-3,
          .cohesion_N_m = cohesion_N_m,
          .gravity_m_s2 = {0, 0, 0}};
}

/// A tank of water or sand with an analytic shape in its centre.
inline MatterScene modelInTank(std::string_view shape, double size_mm, Matter matter = Matter::water) {
  MatterScene scene = tank({14, 18, 14}, 14);
  scene.matter = matter;
  scene.model = "builtin:" + std::string(shape);
  scene.model_mm = DVec3(size_mm);
  scene.model_at_mm = DVec3(70, 60 - size_mm / 2, 70);
  return scene;
}

inline std::size_t withinBall(const MatterSimulation& world, const DVec3& middle_m, double radius_m) {
  const std::vector<Vec3> places = world.positionsById();
  return static_cast<std::size_t>(std::ranges::count_if(
      places, [&](const Vec3& place) { return glm::length(DVec3(place) - middle_m) < radius_m; }));
}

/// Largest distance of a particle outside of the box, m.
inline double farthestOut(const MatterSimulation& world) {
  double out = 0;
  for (const Vec3& place : world.positionsById())
    for (int axis = 0; axis < 3; ++axis)
      out = std::max({out, -static_cast<double>(place[axis]),
                      static_cast<double>(place[axis]) - world.scene().box_mm[axis] * 1e-3});
  return out;
}

/// Matter that falls onto the scene's model.
inline void checkModelKeepsOut(const MatterMaker& make, const MatterScene& scene, int steps) {
  // Water that falls onto the model in an otherwise empty tank.
  std::vector<Vec3> places;
  for (int z = 0; z < 12; ++z)
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 12; ++x) places.emplace_back(Vec3(x, y, z) * 0.01f + Vec3(0.015f, 0.106f, 0.015f));
  const auto world = make(scene, 0, places);
  REQUIRE(world->leftOut() < places.size() / 4);
  for (int k = 0; k < steps; ++k) {
    run(*world, 1);
    REQUIRE(missingMomentum(*world) <= 1e-5);
    if (k % 10 != 9) continue;
    REQUIRE(world->insideModel() == 0);
    REQUIRE(farthestOut(*world) == 0);
  }
  CHECK(glm::length(world->impulses().onModel) > 0.01);
}

}  // namespace palpate
