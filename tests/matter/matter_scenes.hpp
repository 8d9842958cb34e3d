// Scenes and checks shared by the tests.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
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

}  // namespace palpate
