// Makes soft bodies on the CPU, and their scenes.
#pragma once

#include "engine/matter/soft_lattice.hpp"
#include "engine/matter/soft_world.hpp"
#include "tests/matter/matter_scenes.hpp"

namespace palpate {

/// Makes a simulation of a soft body with the implementation under test; a null `solid` selects the scene's shape.
using SoftMaker = std::function<std::unique_ptr<MatterSimulation>(
    const MatterScene& scene, std::size_t tools, const SoftSolid* solid, std::span<const SurfacePlace> points)>;
/// Sets the displacement of every node from rest, m.
using SoftBend = std::function<void(MatterSimulation& world, std::span<const Vec3> displacements)>;

inline SoftMaker softOnCpu(unsigned threads = 2) {
  return [threads](const MatterScene& scene, std::size_t tools, const SoftSolid* solid,
                   std::span<const SurfacePlace> points) -> std::unique_ptr<MatterSimulation> {
    const MatterOptions options{.threads = threads, .tools = tools};
    if (solid == nullptr) return std::make_unique<SoftWorld>(scene, options);
    return std::make_unique<SoftWorld>(scene, options, *solid, points);
  };
}

inline SoftBend bendOnCpu() {
  return [](MatterSimulation& world, std::span<const Vec3> displacements) {
    std::ranges::copy(displacements, dynamic_cast<SoftWorld&>(world).body().displacements().begin());
  };
}

/// A block of 50 x 40 x 50 mm on the floor, for a hand with a ball.
inline MatterScene softBlock() {
  return {.matter = Matter::soft,
          .box_mm = {100, 120, 100},
          .fill_mm = {50, 40, 50},
          .spacing_mm = 5,
          .viscosity_Pa_s = 3,
          .young_Pa = 3e4,
          .tool = {.radius_mm = 12, .mass_kg = 0.02}};
}

}  // namespace palpate
