// Scenes for the tests, and what is asked of them again and again.
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

namespace palpate {

inline constexpr double kGravity_m_s2 = 9.81;

/// Makes a simulation on what is tested.
using MatterMaker = std::function<std::unique_ptr<MatterSimulation>(const MatterScene& scene, std::size_t tools,
                                                                    std::vector<Vec3> places)>;
inline MatterMaker onCpu(unsigned threads = 2) {
  return [threads](const MatterScene& scene, std::size_t tools, std::vector<Vec3> places) {
    return std::make_unique<MatterWorld>(scene, MatterOptions{.threads = threads, .tools = tools}, std::move(places));
  };
}

/// A tank that is filled from wall to wall, of whole spacings.
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

/// Momentum that neither gravity nor walls, tools or a model have given, of all that gravity gave.
inline double missingMomentum(const MatterSimulation& world) {
  const MatterImpulses& given = world.impulses();
  return glm::length(world.totals().momentum - (given.gravity - given.onWalls - given.onTools - given.onModel)) /
         glm::length(given.gravity);
}

/// Whether a value is what is expected, but for a share of that. Shows both where it is not.
inline bool isWithin(double share, double value, double expected) {
  if (std::abs(value - expected) <= share * std::abs(expected)) return true;
  MESSAGE(value);
  MESSAGE(expected);
  return false;
}

/// Holds what was measured of a quantity against its truth, and says both, so that a run of the tests gives the table
/// of truths (apps/bench/README.md).
inline void checkTruth(const std::string& quantity, double measured, double truth, double share) {
  MESSAGE(fmt::format("{}: {:.4g} of {:.4g}, {:+.2f} % of {:g} %", quantity, measured, truth,
                      100 * (measured - truth) / std::abs(truth), 100 * share));
  CHECK(std::abs(measured - truth) <= share * std::abs(truth));
}

/// The same where the truth is that there is none of it, or not more.
inline void checkAtMost(const std::string& quantity, double measured, double most) {
  MESSAGE(fmt::format("{}: {:.3g} of {:g} at most", quantity, measured, most));
  CHECK(measured <= most);
}

/// Whether two simulations are in the same state, to the last bit.
inline bool sameBytes(const MatterSimulation& a, const MatterSimulation& b) {
  const auto same = [](const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(Vec3)) == 0;
  };
  return same(a.positionsById(), b.positionsById()) && same(a.velocitiesById(), b.velocitiesById());
}

/// What a scene is refused with; "taken" where it is not.
inline std::string refusal(const MatterScene& scene, std::uint64_t memory_bytes = std::uint64_t{2} << 30) {
  try {
    planOf(scene, memory_bytes);
  } catch (const Error& error) {
    return error.what();
  }
  return "taken";
}

}  // namespace palpate
